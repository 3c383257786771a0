// Runs a program, the built wavepath, as a user would, and says what it printed and how it ended.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

namespace wavepath::test {

struct Outcome {
  int exit_code = -1; // 128 + the signal if one ended it
  std::string out, err;
};

struct RunOptions {
  bool terminal = false;    // stderr is a terminal
  std::string signal_after; // send `signal` once stderr holds this
  int signal = 0;
  std::function<void()> in_child; // before the program starts
  std::string folder;             // working directory
};

// A system root that was entered without /dev/pts has none.
inline bool has_terminals() {
  int ends[2];
  if (openpty(&ends[0], &ends[1], nullptr, nullptr, nullptr) != 0) return false;
  for (const int end : ends) close(end);
  return true;
}

// `arguments`: the program first.
inline Outcome run_program(std::vector<std::string> arguments, const RunOptions& options = {}) {
  int out[2], err[2];
  const bool opened =
      pipe(out) == 0 && (options.terminal ? openpty(&err[0], &err[1], nullptr, nullptr, nullptr) : pipe(err)) == 0;
  EXPECT_TRUE(opened) << "no pipe or no terminal";
  if (!opened) return {};
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);

  const pid_t child = fork();
  if (child == 0) {
    dup2(out[1], STDOUT_FILENO);
    dup2(err[1], STDERR_FILENO);
    for (const int descriptor : {out[0], out[1], err[0], err[1]}) close(descriptor);
    if (!options.folder.empty() && chdir(options.folder.c_str()) != 0) _exit(99);
    setenv("TERM", "xterm", 1);
    if (options.in_child) options.in_child();
    execv(pointers[0], pointers.data());
    _exit(99);
  }
  close(out[1]);
  close(err[1]);

  Outcome outcome;
  bool signalled = options.signal == 0;
  pollfd sources[2] = {{out[0], POLLIN, 0}, {err[0], POLLIN, 0}};
  while (sources[0].fd >= 0 || sources[1].fd >= 0) {
    poll(sources, 2, -1);
    for (int i = 0; i < 2; ++i) {
      if (sources[i].fd < 0 || sources[i].revents == 0) continue;
      char buffer[4096];
      const ssize_t count = read(sources[i].fd, buffer, sizeof buffer);
      if (count <= 0) { // a terminal whose other end is closed gives EIO
        close(sources[i].fd);
        sources[i].fd = -1;
        continue;
      }
      (i == 0 ? outcome.out : outcome.err).append(buffer, static_cast<std::size_t>(count));
    }
    if (!signalled && outcome.err.find(options.signal_after) != std::string::npos) {
      kill(child, options.signal);
      signalled = true;
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

} // namespace wavepath::test
