#include "host/study/page.h"

#include <cstdio>
#include <cstring>
#include <memory>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "host/base/error.h"

namespace wavepath {
namespace {

constexpr int kNoMatplotlib = 3; // exit code of the script
constexpr int kNoPython = 127;   // as a shell has it

// A file without a name rather than a pipe, which would break if Python ended early.
std::unique_ptr<std::FILE, int (*)(std::FILE*)> script_file(const std::string& page) {
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), std::fclose);
  const std::size_t length = std::strlen(kStudyReportScript);
  if (!file || std::fwrite(kStudyReportScript, 1, length, file.get()) != length || std::fflush(file.get()) != 0)
    throw Error(page, "no temporary file can be written", "make room in the temporary folder");
  return file;
}

// The exit code.
int run_python(const std::string& python, int script, const std::string& folder) {
  lseek(script, 0, SEEK_SET);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, script, STDIN_FILENO);
  std::string words[] = {python, "-B", "-", folder};
  char* const arguments[] = {words[0].data(), words[1].data(), words[2].data(), words[3].data(), nullptr};
  pid_t child = 0;
  const int failure = posix_spawnp(&child, arguments[0], &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  if (failure != 0 || waitpid(child, &status, 0) != child) return kNoPython;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

} // namespace

void write_page(const std::string& folder) {
  const std::string page = folder + "/report.html";
  const auto script = script_file(page);
  int code = 0;
  // The user's own Python may lack what the distribution's package has installed for its own.
  for (const char* python : {"python3", "/usr/bin/python3"}) {
    code = run_python(python, fileno(script.get()), folder);
    if (code != kNoPython && code != kNoMatplotlib) break;
  }
  if (code == 0) return;
  const char* again = "then run benchmarks/study_report.py on the folder; study.json and study.csv are there";
  if (code == kNoPython)
    throw Error(page, "python3 is not there to make it", fmt::format("install python3-matplotlib, {}", again));
  if (code == kNoMatplotlib)
    throw Error(page, "matplotlib is not there to plot it", fmt::format("install python3-matplotlib, {}", again));
  throw Error(page, fmt::format("the script that makes it ended with code {}", code),
              "see above; study.json and study.csv are there");
}

} // namespace wavepath
