#include "host/selftest/selftest.h"

#include <cmath>

#include <fmt/format.h>

#include "host/base/clock.h"
#include "host/base/error.h"
#include "host/gpu/device_limit.h"

namespace wavepath {

std::vector<SelftestCase> selftest_cases() {
  std::vector<SelftestCase> cases;
  for (const std::span<const SelftestCase> table :
       {watertight_cases(), ray_cases(), query_cases(), offset_cases(), mesh_cases(), tree_cases(),
        accumulation_cases(), number_cases(), scale_cases(), ground_cases(), furnace_cases(), glass_cases(),
        light_cases(), environment_cases()})
    cases.insert(cases.end(), table.begin(), table.end());
  return cases;
}

SelftestResult run_case(const SelftestCase& test, const SelftestContext& context) {
  const Clock::time_point start = Clock::now();
  SelftestResult result{&test, {}, 0.0};
  try {
    result.measurement = test.run(context);
  } catch (const DeviceLimit& error) {
    result.measurement = {"runs", "refused", "", Verdict::skip, error.what()};
  } catch (const Error& error) {
    result.measurement = {"runs", "error", "", Verdict::fail, error.what()};
  }
  result.seconds = seconds_since(start);
  return result;
}

std::string_view verdict_name(Verdict verdict) {
  return verdict == Verdict::pass ? "PASS" : verdict == Verdict::fail ? "FAIL" : "SKIP";
}

Measurement judge_near(double measured, double expected, double tolerance, std::string note) {
  const bool near = std::abs(measured - expected) <= tolerance; // false for NaN
  return {fmt::format("{:.8g}", expected), fmt::format("{:.8g}", measured), fmt::format("{:.2g}", tolerance),
          near ? Verdict::pass : Verdict::fail, std::move(note)};
}

Measurement judge_none(std::uint64_t failures, std::uint64_t trials, const std::string& what) {
  return {"0 " + what, fmt::format("{} of {}", failures, trials), "exact",
          failures == 0 ? Verdict::pass : Verdict::fail};
}

} // namespace wavepath
