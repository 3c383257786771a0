// Commands of the interface.
#include <wavepath/command.h>

#include <algorithm>
#include <string>
#include <vector>

#include "host/base/error.h"
#include "host/base/print.h"
#include "host/cli/program.h"
#include "host/library/guard.h"

namespace wavepath_v0 {
namespace {

// Commands that neither render for long nor change the process.
constexpr const char* kKept[] = {"info", "compare", "merge"};

} // namespace

Printed command(const std::vector<std::string>& words) {
  return wavepath::guarded([&] {
    if (words.empty() || std::ranges::count(kKept, words.front()) == 0)
      throw wavepath::UsageError(words.empty() ? "command" : words.front(), "is no command of a library",
                                 "choose from info, compare, merge; or run the program");
    std::vector<const char*> arguments = {"wavepath"};
    for (const std::string& word : words) arguments.push_back(word.c_str());
    wavepath::KeptWords kept;
    const int exit_code = wavepath::run(static_cast<int>(arguments.size()), arguments.data());
    return Printed{std::move(kept.out), std::move(kept.err), exit_code};
  });
}

int command_line(int argument_count, const char* const* arguments) {
  return wavepath::run_program(argument_count, arguments);
}

} // namespace wavepath_v0
