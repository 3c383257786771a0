// The signal handlers.
#include "host/cli/interrupt.h"

#include <csignal>
#include <initializer_list>

namespace wavepath {
namespace {

volatile std::sig_atomic_t interrupt_count = 0;

void on_signal(int signal) {
  interrupt_count = 1;
  if (signal == SIGHUP) return;
  // Both, so that one after the other ends the process too.
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

} // namespace

void catch_interrupts() {
  // SA_RESTART: a driver's system calls are not expected to cope with being interrupted.
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  // A signal that the parent told us to ignore (nohup, background jobs) stays ignored.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
}

void ignore_write_signals() {
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

bool interrupted() { return interrupt_count != 0; }

} // namespace wavepath
