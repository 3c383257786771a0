// Runs the tests of one program. A test that is skipped checks nothing, so the program says which were and exits with
// 77, which CTest shows as "Skipped".
#include <cstdio>

#include <gtest/gtest.h>

namespace {

constexpr int kSkippedExitCode = 77; // SKIP_RETURN_CODE in tests/CMakeLists.txt

// Prints every skipped test with its reason; returns their number.
int report_skipped(const ::testing::UnitTest& tests) {
  int count = 0;
  for (int s = 0; s < tests.total_test_suite_count(); ++s) {
    const ::testing::TestSuite& suite = *tests.GetTestSuite(s);
    for (int t = 0; t < suite.total_test_count(); ++t) {
      const ::testing::TestInfo& test = *suite.GetTestInfo(t);
      if (!test.should_run() || !test.result()->Skipped()) continue;
      ++count;
      for (int i = 0; i < test.result()->total_part_count(); ++i)
        if (test.result()->GetTestPartResult(i).skipped())
          std::fprintf(stderr, "SKIPPED: %s.%s: %s\n", suite.name(), test.name(),
                       test.result()->GetTestPartResult(i).message());
    }
  }
  if (count > 0) std::fprintf(stderr, "SKIPPED: %d of %d tests check nothing here\n", count, tests.test_to_run_count());
  return count;
}

} // namespace

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  const int result = RUN_ALL_TESTS();
  const int skipped = report_skipped(*::testing::UnitTest::GetInstance());
  return result == 0 && skipped > 0 ? kSkippedExitCode : result;
}
