// wavepath selftest: runs the numerical suite on one device and says, a line a case, what came out.
#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/render/stats.h"
#include "host/selftest/selftest.h"
#include "host/selftest/traced_scene.h"

namespace wavepath {
namespace {

using Json = nlohmann::ordered_json;

struct Request {
  std::string device;
  std::vector<std::string> only;
  bool full = false, json = false;
};

bool wanted(const Request& request, const SelftestCase& test) {
  if (request.only.empty()) return true;
  for (const std::string& part : request.only)
    if (std::string_view(test.name).find(part) != std::string_view::npos) return true;
  return false;
}

void print(const SelftestResult& result) {
  const Measurement& m = result.measurement;
  fmt::print("{}  {:<44} expected {}, measured {}, tolerance {}  ({:.1f} s)\n", verdict_name(m.verdict),
             result.of->name, m.expected, m.measured, m.tolerance, result.seconds);
  if (!m.note.empty()) fmt::print("      {}\n", m.note);
  if (m.verdict == Verdict::fail) fmt::print("      what this means for your images: {}\n", result.of->meaning);
  std::fflush(stdout);
}

Json to_json(const SelftestResult& result) {
  const Measurement& m = result.measurement;
  std::string note = m.note;
  if (m.verdict == Verdict::fail)
    note += (note.empty() ? "" : "; ") + std::string("for your images: ") + result.of->meaning;
  return {{"name", result.of->name},
          {"expected", m.expected},
          {"measured", m.measured},
          {"tolerance", m.tolerance},
          {"verdict", verdict_name(m.verdict)},
          {"note", note},
          {"row", result.of->row},
          {"seconds", result.seconds}};
}

int run_selftest(const Request& request) {
  const std::vector<SelftestCase> cases = selftest_cases();
  Device device(request.device);
  KernelCache kernels(device);
  if (!request.json) fmt::print("{} ({})\n", device.info().name, device.info().driver);
  Json document = Json::array();
  std::size_t failed = 0, skipped = 0, run = 0;
  for (const SelftestCase& test : cases) {
    if (!wanted(request, test)) continue;
    const SelftestResult result = run_case(test, {device, kernels, request.full});
    ++run;
    failed += result.measurement.verdict == Verdict::fail;
    skipped += result.measurement.verdict == Verdict::skip;
    if (request.json)
      document.push_back(to_json(result));
    else
      print(result);
  }
  if (run == 0) throw UsageError("--only", "names no case", "see the names in the output of 'wavepath selftest'");
  if (request.json)
    fmt::print("{}", to_text(document));
  else
    fmt::print("{} cases: {} passed, {} failed, {} skipped\n", run, run - failed - skipped, failed, skipped);
  return failed > 0 ? kExitFailed : kExitDone;
}

} // namespace

Command add_selftest(CLI::App& app) {
  CLI::App* command = app.add_subcommand("selftest", "prove the hard numerical cases on this device and driver");
  command->set_help_flag("-h,--help", "show this and exit")->group(kHelpGroup);
  const auto request = std::make_shared<Request>();
  const char* group = "Cases";
  add_flag(
      *command, group, {"--only", "NAME", "repeatable; run only the cases whose name holds this", "all"},
      [=](const FlagValue& value) { request->only.push_back(value.text); }, true);
  add_switch(*command, group, {"--full", "", "with the sample counts of the literature; takes much longer", "off"},
             request->full);
  add_switch(*command, "Output", {"--json", "", "print one JSON document", "off"}, request->json);
  add_flag(*command, "Device",
           {"--device", "NAME|INDEX", "Vulkan device; 'wavepath info' lists them", "a discrete GPU if there is one"},
           [=](const FlagValue& value) { request->device = value.text; });
  return [request] { return run_selftest(*request); };
}

} // namespace wavepath
