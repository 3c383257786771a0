// The numerical suite around its cases: verdicts, exit codes, output; and that cases 1 to 44 exist.
// The cases themselves run as a test of their own.
#include <cmath>
#include <limits>
#include <set>

#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/cli/commands.h"
#include "host/cli/selftest_report.h"
#include "host/gpu/device_limit.h"
#include "host/selftest/traced_scene.h"
#include "tests/probe.h"
#include "tests/run_wavepath.h"

namespace wavepath::test {
namespace {

using Json = nlohmann::json;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();

TEST(Judge, NearMeansWithinTheToleranceAndIsANumber) {
  EXPECT_EQ(judge_near(1.0, 1.0, 0.0).verdict, Verdict::pass);
  EXPECT_EQ(judge_near(1.25, 1.0, 0.25).verdict, Verdict::pass);
  EXPECT_EQ(judge_near(0.7, 1.0, 0.25).verdict, Verdict::fail);
  EXPECT_EQ(judge_near(kNan, 1.0, 0.25).verdict, Verdict::fail);
  EXPECT_EQ(judge_near(1.0, kNan, 0.25).verdict, Verdict::fail);
  EXPECT_EQ(judge_near(kInf, 1.0, 0.25).verdict, Verdict::fail);
  EXPECT_EQ(judge_near(1.0, 1.0, kNan).verdict, Verdict::fail);
  EXPECT_EQ(judge_near(kNan, 1.0, 0.25).measured, "nan");
}

TEST(Judge, NoneMeansNone) {
  EXPECT_EQ(judge_none(0, 7, "leaks").verdict, Verdict::pass);
  EXPECT_EQ(judge_none(1, 7, "leaks").verdict, Verdict::fail);
  EXPECT_EQ(judge_none(1, 7, "leaks").measured, "1 of 7");
}

TEST(Cases, HaveNamesMeaningsAndRows) {
  std::set<std::string> names;
  std::set<int> rows;
  for (const SelftestCase& test : selftest_cases()) {
    EXPECT_TRUE(names.insert(test.name).second) << test.name;
    EXPECT_STRNE(test.meaning, "") << test.name;
    rows.insert(test.row);
  }
  for (int row = 1; row <= 44; ++row) // the numbered cases
    EXPECT_TRUE(rows.contains(row)) << row;
}

constexpr SelftestCase kPasses = {1, "one that passes", "nothing",
                                  [](const SelftestContext&) { return judge_near(1.0, 1.0, 0.5, "a note"); }};
constexpr SelftestCase kFails = {2, "one that fails", "all is wrong",
                                 [](const SelftestContext&) { return judge_near(2.0, 1.0, 0.5); }};
constexpr SelftestCase kThrows = {3, "one that breaks", "all is wrong", [](const SelftestContext&) -> Measurement {
                                    throw Error("FILE", "is broken", "mend it");
                                  }};
constexpr SelftestCase kIsRefused = {5, "one that asks too much", "nothing", [](const SelftestContext&) -> Measurement {
                                       throw DeviceLimit("DEVICE", "has few buffers", "use another device");
                                     }};
constexpr SelftestCase kSkips = {4, "one that cannot be", "nothing", [](const SelftestContext&) {
                                   return Measurement{"x", "y", "z", Verdict::skip, "for a reason"};
                                 }};

class SelftestReport : public VulkanTest {
protected:
  struct Output {
    int exit_code;
    std::string text;
  };
  Output report(const std::vector<SelftestCase>& cases, const SelftestRequest& request = {}) {
    KernelCache kernels(device());
    ::testing::internal::CaptureStdout();
    const int code = report_cases(cases, {device(), kernels, false}, request);
    return {code, ::testing::internal::GetCapturedStdout()};
  }
};

TEST_F(SelftestReport, OneFailureFailsAll) {
  EXPECT_EQ(report({kPasses, kSkips}).exit_code, kExitDone);
  EXPECT_EQ(report({kPasses, kFails}).exit_code, kExitFailed);
  EXPECT_EQ(report({kThrows, kPasses}).exit_code, kExitFailed);
}

TEST_F(SelftestReport, SkipsWhatTheDeviceRefuses) {
  const Output output = report({kPasses, kIsRefused});
  EXPECT_EQ(output.exit_code, kExitDone);
  EXPECT_NE(output.text.find("SKIP  one that asks too much"), std::string::npos) << output.text;
  EXPECT_NE(output.text.find("has few buffers"), std::string::npos) << output.text;
}

TEST_F(SelftestReport, TellsALineACaseAndWhatAFailureMeans) {
  const std::string text = report({kPasses, kFails, kThrows, kSkips}).text;
  EXPECT_NE(text.find("PASS  one that passes"), std::string::npos);
  EXPECT_NE(text.find("expected 1, measured 2, tolerance 0.5"), std::string::npos);
  EXPECT_NE(text.find("what this means for your images: all is wrong"), std::string::npos);
  EXPECT_NE(text.find("is broken"), std::string::npos);
  EXPECT_NE(text.find("for a reason"), std::string::npos);
  EXPECT_NE(text.find("4 cases: 1 passed, 2 failed, 1 skipped"), std::string::npos);
}

TEST_F(SelftestReport, RunsOnlyWhatIsAskedFor) {
  EXPECT_EQ(report({kPasses, kFails}, {.only = {"that pass"}}).exit_code, kExitDone);
  EXPECT_EQ(report({kPasses, kFails}, {.only = {"that pass", "fail"}}).exit_code, kExitFailed);
}

TEST_F(SelftestReport, JsonHasTheDocumentedFields) {
  const Json document = Json::parse(report({kPasses, kFails, kSkips}, {.json = true}).text);
  ASSERT_EQ(document.size(), 3u);
  const char* verdicts[] = {"PASS", "FAIL", "SKIP"};
  for (std::size_t i = 0; i < 3; ++i) {
    for (const char* field : {"name", "expected", "measured", "tolerance", "verdict", "note"})
      EXPECT_TRUE(document[i].at(field).is_string()) << field;
    EXPECT_EQ(document[i]["verdict"], verdicts[i]);
  }
  EXPECT_EQ(document[0]["note"], "a note");
  EXPECT_NE(document[1]["note"].get<std::string>().find("all is wrong"), std::string::npos);
}

class SelftestCommand : public ProgramTest {};

TEST_F(SelftestCommand, RefusesNamesThatAreNone) {
  const Outcome outcome = run_program({WAVEPATH_BINARY, "selftest", "--only", "no such case"});
  EXPECT_EQ(outcome.exit_code, kExitUsage);
  EXPECT_NE(outcome.err.find("--only"), std::string::npos);
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1);
}

TEST_F(SelftestCommand, PrintsJsonAlone) {
  const Outcome outcome = run_program({WAVEPATH_BINARY, "selftest", "--only", "empty scene", "--json"});
  EXPECT_EQ(outcome.exit_code, kExitDone);
  const Json document = Json::parse(outcome.out);
  ASSERT_EQ(document.size(), 1u);
  EXPECT_EQ(document[0]["row"], 17);
}

} // namespace
} // namespace wavepath::test
