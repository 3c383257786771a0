// wavepath selftest: the numerical suite on one device.
#include <memory>

#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/cli/selftest_report.h"
#include "host/selftest/traced_scene.h"

namespace wavepath {
namespace {

struct SelftestCommandRequest : SelftestRequest {
  std::string device;
  bool full = false;
};

int run_selftest(const SelftestCommandRequest& request) {
  Device device(request.device);
  device.keep_pipelines(); // cases differ in scenes more than in kernels
  KernelCache kernels(device);
  return report_cases(selftest_cases(), {device, kernels, request.full}, request);
}

} // namespace

Command add_selftest(CLI::App& app) {
  CLI::App* command = add_command(app, "selftest", "check difficult numerical cases on this device and driver");
  const auto request = std::make_shared<SelftestCommandRequest>();
  const char* group = "Cases";
  add_flag(
      *command, group, {"--only", "NAME", "text in the names of the cases to run; repeatable", "all"},
      [=](const FlagValue& value) { request->only.push_back(value.text); }, true);
  add_switch(*command, group, {"--full", "", "use the sample counts of the literature, which takes much longer", "off"},
             request->full);
  add_switch(*command, "Output", {"--json", "", "print one JSON document", "off"}, request->json);
  add_flag(*command, "Device",
           {"--device", "NAME|INDEX", "Vulkan device. 'wavepath info' lists them", "a discrete GPU if there is one"},
           [=](const FlagValue& value) { request->device = value.text; });
  return [request] { return run_selftest(*request); };
}

} // namespace wavepath
