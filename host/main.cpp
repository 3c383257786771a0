// wavepath: runs a command and turns every failure into one line and an exit code.
#include <cstdio>
#include <exception>
#include <new>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/process_clock.h"
#include "host/cli/commands.h"
#include "host/gpu/device.h"

namespace {

int fail(int exit_code, const char* message) {
  fmt::print(stderr, "wavepath: error: {}\n", message);
  return exit_code;
}

int run_and_report(int argument_count, const char* const* arguments) try {
  return wavepath::run(argument_count, arguments);
} catch (const wavepath::UsageError& error) {
  return fail(wavepath::kExitUsage, error.what());
} catch (const wavepath::Error& error) {
  return fail(wavepath::kExitFailed, error.what());
} catch (const std::bad_alloc&) {
  return fail(wavepath::kExitFailed, "memory: ran out; use a smaller size or scene, or close other programs");
} catch (const std::exception& error) {
  return fail(wavepath::kExitFailed, fmt::format("wavepath: unexpected error ({}); report this", error.what()).c_str());
}

} // namespace

int main(int argument_count, char** arguments) {
  wavepath::seconds_since_process_start(); // the clock starts
  const int exit_code = run_and_report(argument_count, arguments);
  const auto messages = wavepath::Device::validation_messages();
  if (messages > 0)
    return fail(wavepath::kExitFailed, fmt::format("Vulkan validation: {} messages; report them", messages).c_str());
  if (std::fflush(stdout) != 0)
    return fail(wavepath::kExitFailed, "stdout: cannot be written; free some space or write elsewhere");
  return exit_code;
}
