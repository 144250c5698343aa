#include "firmware/threads/matcher_loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/simulated_room.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kPlenty_ns = 10'000'000'000;
constexpr int kScans = 4;

/// A search that no budget is enough for.
RobotParams endless() {
  RobotParams params;
  params.matcher.search.coarse_evaluations = params.matcher.search.fine_evaluations = 1'000'000;
  return params;
}

/// The matcher's thread, after it was given some scans.
MatcherReport after_scans(const RobotParams& robot, std::int64_t budget_ns) {
  Pipeline pipeline(PipelineParams{}, robot, false);
  MatcherStage stage(robot, 1);
  MatcherLoop loop(pipeline, stage, budget_ns, false);
  SimulatedRoom room(4, 400);
  pipeline.sensor.done.store(true);  // nothing comes but what is there
  for (int i = 0; i < kScans; ++i) {
    room.step();
    pipeline.pool.at(0) = room.scan();
    EXPECT_FALSE(pipeline.scans.push(0));
    loop.run();
    ScanSlot slot = kNoSlot;
    EXPECT_TRUE(pipeline.slots_from_matcher.try_pop(slot));
  }
  EXPECT_TRUE(pipeline.matcher.report.update());
  return pipeline.matcher.report.value();
}

TEST(MatcherLoop, EndsAnyMatchWithinItsBudget) {
  // What a match ends with takes less than a whole one does; its share of the budget has to be more, on any machine.
  const std::int64_t ordinary_ns = after_scans(RobotParams{}, kPlenty_ns).stage.cpu.max();
  const MatcherReport report = after_scans(endless(), std::max<std::int64_t>(100'000'000, 10 * ordinary_ns));
  EXPECT_TRUE(report.deadline_hit);
  EXPECT_EQ(report.stage.scans, kScans);
  EXPECT_EQ(report.stage.deadline_misses, 0) << "longest: " << report.stage.cpu.max() << " ns";
}

TEST(MatcherLoop, CutsNoMatchThatHasTime) {
  const MatcherReport report = after_scans(RobotParams{}, kPlenty_ns);
  EXPECT_FALSE(report.deadline_hit);
  EXPECT_EQ(report.stage.deadline_misses, 0);
  EXPECT_GE(report.evaluations, RobotParams{}.matcher.search.fine_evaluations);
}

}  // namespace
}  // namespace odoless
