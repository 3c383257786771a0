#include "host/cli/selftest_report.h"

#include <cstdio>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/print.h"
#include "host/cli/commands.h"
#include "host/render/report/stats.h"

namespace wavepath {
namespace {

using Json = nlohmann::ordered_json;

bool wanted(const SelftestRequest& request, const SelftestCase& test) {
  if (request.only.empty()) return true;
  for (const std::string& part : request.only)
    if (std::string_view(test.name).find(part) != std::string_view::npos) return true;
  return false;
}

void print(const SelftestResult& result) {
  const Measurement& m = result.measurement;
  print_out("{}  {:<44} expected {}, measured {}, tolerance {}  ({:.1f} s)\n", verdict_name(m.verdict), result.of->name,
            m.expected, m.measured, m.tolerance, result.seconds);
  if (!m.note.empty()) print_out("      {}\n", m.note);
  if (m.verdict == Verdict::fail) print_out("      what this means for your images: {}\n", result.of->meaning);
  flush_out();
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

} // namespace

int report_cases(std::span<const SelftestCase> cases, const SelftestContext& context, const SelftestRequest& request) {
  const DeviceInfo& device = context.device.info();
  if (!request.json) print_out("{} ({})\n", device.name, device.driver);
  Json document = Json::array();
  std::size_t failed = 0, skipped = 0, run = 0;
  for (const SelftestCase& test : cases) {
    if (!wanted(request, test)) continue;
    const SelftestResult result = run_case(test, context);
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
    print_out("{}", to_text(document));
  else
    print_out("{} cases: {} passed, {} failed, {} skipped\n", run, run - failed - skipped, failed, skipped);
  return failed > 0 ? kExitFailed : kExitDone;
}

} // namespace wavepath
