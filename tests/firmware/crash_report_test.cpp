#include "firmware/daemon/crash_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <csignal>
#include <functional>

#include "core/base/check.hpp"
#include "firmware/daemon/real_time_entry.hpp"
#include "rt/real_time_thread.hpp"
#include "tests/support/sanitizers.hpp"
#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::KilledBySignal;
using ::testing::Not;
using ::testing::StartsWith;

/// Nobody may write there.
volatile char* forbidden_page() {
  static void* const page = ::mmap(nullptr, 1, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  return static_cast<volatile char*>(page);
}

void write_where_nobody_may() { *forbidden_page() = 1; }

class CrashReporterDeathTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ::testing::FLAGS_gtest_death_test_style = "fast";  // the folder is the same in the child
    if (test::kThreadSanitizer) {
      GTEST_SKIP() << "ThreadSanitizer has handlers of its own";
    }
  }

  /// Crashes in a process of its own, and returns the report.
  std::string report_of(int signal, const std::function<void()>& crash) {
    const auto run = [&] {
      const CrashReporter reporter(folder_.path(), "test 1.2");
      remember_state("OK: as ever");
      for (int i = 0; i < 100; ++i) {
        remember_log_line("line " + std::to_string(i));
      }
      static_cast<void>(forbidden_page());  // made here: not on a restricted thread
      crash();
    };
    EXPECT_EXIT(run(), KilledBySignal(signal), "crashed by .*; a report is in .*\\.crash");
    return test::content_of(folder_.path() / ".crash");
  }

  test::TemporaryFolder folder_;
};

TEST_F(CrashReporterDeathTest, TellsSignalStateBuildAndTheLastLines) {
  EXPECT_THAT(report_of(SIGSEGV, write_where_nobody_may),
              AllOf(StartsWith("test 1.2, build "), HasSubstr("crashed by SIGSEGV at address 0x"),
                    HasSubstr("state: OK: as ever\n"), HasSubstr("\nline 68\n"), HasSubstr("\nline 99\n"),
                    Not(HasSubstr("\nline 67\n"))));
}

TEST_F(CrashReporterDeathTest, TellsOfASignalThatWasSentAndDiesOfIt) {
  EXPECT_THAT(report_of(SIGBUS, [] { std::raise(SIGBUS); }), HasSubstr("crashed by SIGBUS that was sent"));
}

TEST_F(CrashReporterDeathTest, TellsOfABrokenPromise) {
  EXPECT_THAT(report_of(SIGABRT, [] { ODOLESS_CHECK(1 + 1 == 3); }), HasSubstr("crashed by SIGABRT"));
}

TEST_F(CrashReporterDeathTest, TellsOfARealTimeThreadWhoseSystemCallsAreRestricted) {
  const auto crash = [] {
    RealTimeThread thread({.name = "enforced"});
    ASSERT_EQ(thread.start([] { run_enforced(worker_system_calls(), write_where_nobody_may); }), 0);
    thread.join();
  };
  EXPECT_THAT(report_of(SIGSEGV, crash), HasSubstr("crashed by SIGSEGV at address"));
}

TEST(CrashReporter, KeepsTheReportOfTheRunBeforeAndSaysWhere) {
  const test::TemporaryFolder folder;
  folder.file(".crash", "a report");
  const CrashReporter reporter(folder.path(), "test");
  EXPECT_THAT(reporter.previous(), StartsWith((folder.path() / "crash-2").string()));
  EXPECT_EQ(test::content_of(reporter.previous()), "a report");
  EXPECT_EQ(test::content_of(folder.path() / ".crash"), "");
}

TEST(CrashReporter, LeavesNothingWhereNothingHappens) {
  const test::TemporaryFolder folder;
  {
    const CrashReporter first(folder.path(), "test");
    const CrashReporter second(folder.path(), "another daemon with this folder");
    EXPECT_THAT(second.previous(), IsEmpty());
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  const CrashReporter nowhere("", "test");
  EXPECT_THAT(nowhere.previous(), IsEmpty());
}

}  // namespace
}  // namespace odoless
