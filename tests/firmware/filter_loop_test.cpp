#include "firmware/threads/filter_loop.hpp"

#include <gtest/gtest.h>

#include "tests/support/simulated_room.hpp"
#include "tests/support/times.hpp"

namespace odoless {
namespace {

using test::kSecond;
constexpr int kParticles = 60;

/// So much time that no machine is too slow.
PipelineParams patient() {
  PipelineParams params;
  params.filter_budget_ns = params.scan_budget_ns = 10 * kSecond;
  params.particles_min = 10;
  return params;
}

RobotParams robot() {
  RobotParams params;
  params.slam.low.particles = kParticles;
  params.gate.distance_m = 0.0;  // every scan
  return params;
}

/// The filter's thread, which is given scans whose matches are said to have taken so long.
class FilterLoopRun {
 public:
  FilterLoopRun(const PipelineParams& params, bool lossless)
      : pipeline_(params, robot(), lossless), stage_(robot(), 1), loop_(pipeline_, stage_, params, 5.0) {}

  const FilterReport& after(int scans, std::int64_t matcher_cpu_ns) {
    for (int i = 0; i < scans; ++i) {
      room_.step();
      pipeline_.pool.at(0) = room_.scan();
      MotionMessage message{.slot = 0, .motion = room_.motion(), .matcher_cpu_ns = matcher_cpu_ns};
      message.motion.odom_T_current = room_.map_T_scan();
      EXPECT_TRUE(pipeline_.motions.try_push(message));
      loop_.run(before_);
      ScanSlot slot = kNoSlot;
      EXPECT_TRUE(pipeline_.slots_from_filter.try_pop(slot));
    }
    EXPECT_TRUE(pipeline_.filter.report.update());
    return pipeline_.filter.report.value();
  }

 private:
  const std::atomic<bool> before_{true};  // nothing comes but what is there
  Pipeline pipeline_;
  FilterStage stage_;
  FilterLoop loop_;
  SimulatedRoom room_{4};
};

TEST(FilterLoop, EndsNoUpdateThatHasTime) {
  FilterLoopRun run(patient(), false);
  EXPECT_EQ(run.after(2, 0).particles, patient().particles_min) << "what an update costs here is not known yet";
  const FilterReport report = run.after(80, 0);
  EXPECT_EQ(report.updates_cut, 0);
  EXPECT_GT(report.particles, kParticles / 2) << "it adds as it sees that there is time";
}

TEST(FilterLoop, HasOnlyWhatTheMatchOfItsScanHasLeft) {
  FilterLoopRun run(patient(), false);
  EXPECT_EQ(run.after(30, 0).updates_cut, 0);
  const FilterReport report = run.after(10, 10 * kSecond);
  EXPECT_EQ(report.updates_cut, 10);
  EXPECT_EQ(report.particles, patient().particles_min) << "it asks for fewer";
  EXPECT_EQ(run.after(1, 20 * kSecond).updates_cut, 11) << "nor is there a debt";
}

TEST(FilterLoop, TakesItsTimeInAReplay) {
  const FilterReport report = FilterLoopRun(patient(), true).after(20, 20 * kSecond);
  EXPECT_EQ(report.updates_cut, 0);
  EXPECT_EQ(report.particles, kParticles);
}

TEST(FilterLoop, CountsMatcherAndFilterTogether) {
  const FilterReport report = FilterLoopRun(patient(), false).after(5, 2 * kSecond);
  EXPECT_EQ(report.with_matcher.count(), 5);
  EXPECT_GE(report.with_matcher.max(), 2 * kSecond);
  EXPECT_LT(report.stage.cpu.max(), 2 * kSecond);
}

}  // namespace
}  // namespace odoless
