// wavepath: runs a command and turns every failure into one line and an exit code.
#include <exception>
#include <string>

#include "host/base/failure.h"
#include "host/base/print.h"
#include "host/base/process_clock.h"
#include "host/cli/commands.h"
#include "host/gpu/device.h"

namespace {

int fail(int exit_code, const std::string& message) {
  wavepath::print_err("wavepath: error: {}\n", message);
  return exit_code;
}

int run_and_report(int argument_count, const char* const* arguments) try {
  const int exit_code = wavepath::run(argument_count, arguments);
  wavepath::flush_out();
  return exit_code;
} catch (const wavepath::ReaderGone&) {
  return wavepath::kExitReaderGone; // who wanted to read no more needs no message
} catch (const wavepath::UsageError& error) {
  return fail(wavepath::kExitUsage, error.what());
} catch (const std::exception& error) {
  return fail(wavepath::kExitFailed, wavepath::failure_text(error));
}

} // namespace

int main(int argument_count, char** arguments) {
  wavepath::seconds_since_process_start(); // the clock starts
  wavepath::open_standard_streams();
  const int exit_code = run_and_report(argument_count, arguments);
  const auto messages = wavepath::Device::validation_messages();
  if (messages > 0)
    return fail(wavepath::kExitFailed, fmt::format("Vulkan validation: {} messages; report them", messages));
  return exit_code;
}
