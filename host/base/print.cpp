#include "host/base/print.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fcntl.h>

namespace wavepath {
namespace {

thread_local KeptWords* kept = nullptr; // null = print

[[noreturn]] void fail_out(int problem) {
  if (problem == EPIPE) throw ReaderGone("stdout", "nobody reads it any more", "keep its reader running");
  throw Error("stdout", fmt::format("cannot be written ({})", std::strerror(problem != 0 ? problem : EIO)),
              "free some space or write elsewhere");
}

} // namespace

KeptWords::KeptWords() { kept = this; }
KeptWords::~KeptWords() { kept = nullptr; }

void open_standard_streams() {
  // The wrong way round: what is written to a stream that is not there fails, as it would without this.
  constexpr int kModes[] = {O_WRONLY, O_RDONLY, O_RDONLY};
  for (int descriptor = 0; descriptor < 3; ++descriptor)
    if (fcntl(descriptor, F_GETFD) < 0 && errno == EBADF && open("/dev/null", kModes[descriptor]) < 0) return;
}

void write_err(std::string_view text) {
  if (kept) {
    kept->err += text;
    return;
  }
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void write_out(std::string_view text) {
  if (kept) {
    kept->out += text;
    return;
  }
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) fail_out(errno);
}

void flush_out() {
  if (kept) return;
  errno = 0;
  const bool failed_before = std::ferror(stdout) != 0;
  if (std::fflush(stdout) != 0 || failed_before) fail_out(errno);
}

} // namespace wavepath
