#include "host/cli/program.h"

#include <exception>
#include <span>
#include <string>

#include "host/base/failure.h"
#include "host/base/print.h"
#include "host/base/process_clock.h"
#include "host/cli/interrupt.h"
#include "host/gpu/device.h"

namespace wavepath {
namespace {

int fail(int exit_code, const std::string& message) {
  print_err("wavepath: error: {}\n", message);
  return exit_code;
}

int run_and_report(int argument_count, const char* const* arguments, std::span<const OwnCommand> own) try {
  const int exit_code = run(argument_count, arguments, own);
  flush_out();
  return exit_code;
} catch (const ReaderGone&) {
  return kExitReaderGone; // who wanted to read no more needs no message
} catch (const UsageError& error) {
  return fail(kExitUsage, error.what());
} catch (const std::exception& error) {
  return fail(kExitFailed, failure_text(error));
}

} // namespace

int run_program(int argument_count, const char* const* arguments, std::span<const OwnCommand> own) {
  seconds_since_process_start(); // the clock starts
  open_standard_streams();
  ignore_write_signals();
  const int exit_code = run_and_report(argument_count, arguments, own);
  const auto messages = Device::validation_messages();
  if (messages > 0) return fail(kExitFailed, fmt::format("Vulkan validation: {} messages; report them", messages));
  return exit_code;
}

} // namespace wavepath
