// The numerical suite: cases with a known answer, run on the user's own device and driver.
//
// A case is a row in one of the tables below: what it is called, what a failure means for the user's pictures, and the
// function that measures. To add one, write the function in the file of its subject and a line in that file's table.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/gpu/device.h"

namespace wavepath {

enum class Verdict { pass, fail, skip };

// Numbers as text, because each case has its own units.
struct Measurement {
  std::string expected, measured, tolerance;
  Verdict verdict = Verdict::fail;
  std::string note{}; // why it was skipped, or what else there is to know
};

class KernelCache; // host/selftest/traced_scene.h

struct SelftestContext {
  Device& device;
  KernelCache& kernels;
  bool full = false; // --full: the sample counts of the literature rather than what fits into two minutes
};

struct SelftestCase {
  int row = 0; // number of the case, 1 to 44; 0 for cases without one
  const char* name = "";
  const char* meaning = ""; // consequence of a failure for the user's pictures
  Measurement (*run)(const SelftestContext&) = nullptr;
};

// The tables, by subject.
std::span<const SelftestCase> watertight_cases();
std::span<const SelftestCase> ray_cases();
std::span<const SelftestCase> query_cases();
std::span<const SelftestCase> mesh_cases();
std::span<const SelftestCase> offset_cases();
std::span<const SelftestCase> tree_cases();
std::span<const SelftestCase> accumulation_cases();
std::span<const SelftestCase> number_cases();
std::span<const SelftestCase> furnace_cases();
std::span<const SelftestCase> glass_cases();
std::span<const SelftestCase> light_cases();
std::span<const SelftestCase> environment_cases();
std::span<const SelftestCase> scale_cases();
std::span<const SelftestCase> ground_cases();

// All of them, in the order of the tables.
std::vector<SelftestCase> selftest_cases();

struct SelftestResult {
  const SelftestCase* of = nullptr;
  Measurement measurement;
  double seconds = 0.0;
};

// Runs one; an Error that it throws is a failure with that text, but the case is skipped where a DeviceLimit is in its
// way.
SelftestResult run_case(const SelftestCase& test, const SelftestContext& context);

std::string_view verdict_name(Verdict verdict); // PASS, FAIL, SKIP

// A measurement that passes if |measured - expected| <= tolerance (in the same unit); NaN fails.
Measurement judge_near(double measured, double expected, double tolerance, std::string note = {});
// A measurement that passes if nothing was counted.
Measurement judge_none(std::uint64_t failures, std::uint64_t trials, const std::string& what);

} // namespace wavepath
