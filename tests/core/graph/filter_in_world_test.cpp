// Where the filter's map lies in the world: as the graph says, but where the robot was put elsewhere than the motions
// lead.
#include "core/graph/filter_in_world.hpp"

#include <gtest/gtest.h>

#include "core/slam/lslam.hpp"
#include "tests/core/graph/graph_drive.hpp"

namespace odoless {
namespace {

/// A robot that has gone round a ring of corridors, and a filter that had it where the odometry had it.
class FilterThatIsPlaced : public ::testing::Test {
 protected:
  void SetUp() override {
    run_.drive(kRound);
    ASSERT_GT(run_.graph.submaps().size(), 5U);
    follow({});
  }

  /// @return  Where the world has the robot, which the filter has there.
  Pose2 follow(const Pose2& local_T_odom) {
    where_.update(run_.graph);
    return where_.follow(local_T_odom, odom_T_scan(), placements_, unconfirmed_) * odom_T_scan();
  }
  /// The same of a filter that was put there.
  Pose2 place(const Pose2& local_T_odom) {
    ++placements_;
    return follow(local_T_odom);
  }
  [[nodiscard]] const Pose2& odom_T_scan() const { return run_.odom.back().map_T_scan; }
  /// For a filter that has the robot there.
  [[nodiscard]] Pose2 local_T_odom(const Pose2& local_T_scan) const { return local_T_scan * odom_T_scan().inverse(); }

  /// How far a pose may have drifted where a drive has ended.
  [[nodiscard]] static double drift_m2(const Drive& drive) {
    FilterInWorld where(GraphParams{});
    where.update(drive.graph);
    static_cast<void>(where.follow({}, drive.odom.back().map_T_scan, 0, 0));
    return where.drift().topLeftCorner<2, 2>().trace();
  }

  Drive run_{ring(18.0, 10.0), {}};
  FilterInWorld where_{GraphParams{}};
  int placements_ = 0;
  int unconfirmed_ = 0;
};

TEST_F(FilterThatIsPlaced, IsFollowed) {
  const Pose2 found = odom_T_scan() * Pose2{4.0, 2.0, 0.5};  // it was carried: the odometry does not know
  EXPECT_LT(place(local_T_odom(found)).distance_m(found), 0.1);
}

TEST_F(FilterThatIsPlaced, IsLeftToItselfOnceTheGraphAgrees) {
  const Pose2 found = odom_T_scan() * Pose2{4.0, 2.0, 0.5};
  static_cast<void>(place(local_T_odom(found)));
  const Pose2 home = odom_T_scan();
  static_cast<void>(place(local_T_odom(home)));  // it is put back
  const Pose2 slipped = odom_T_scan() * Pose2{0.3, 0.0, 0.0};
  EXPECT_LT(follow(local_T_odom(slipped)).distance_m(home), 1e-9) << "the world has the odometry's motion";
}

TEST_F(FilterThatIsPlaced, IsFollowedByTheLastKnownPlaceWhereNoneIsNear) {
  const Pose2 found = odom_T_scan() * Pose2{4.0, 2.0, 0.5};
  static_cast<void>(place(local_T_odom(found)));
  const Pose2 unknown{200.0, 100.0, 1.0};
  EXPECT_LT(place(local_T_odom(unknown)).distance_m(unknown), 0.2);
}

TEST_F(FilterThatIsPlaced, IsNotFollowedOnceALoopFromBeyondIsClosed) {
  const Pose2 jump = local_T_odom(odom_T_scan() * Pose2{4.0, 2.0, 0.5});  // wrong: the robot is where it was
  EXPECT_GT(place(jump).distance_m(odom_T_scan()), 2.0);
  run_.drive({{kRound[0].x_m, kRound[0].y_m}, {kRound[0].x_m + 2.0, kRound[0].y_m}});
  EXPECT_GT(follow(jump).distance_m(odom_T_scan()), 1.0) << "nothing is closed yet";
  run_.drive(kRound);
  EXPECT_LT(follow(jump).distance_m(odom_T_scan()), 0.3);
}

// The filter lost the robot for nothing, or it was carried: nobody knows until there is a loop.
TEST_F(FilterThatIsPlaced, IsUncertainAfterItWentOnUnconfirmedUntilALoopFromBeyondIsClosed) {
  EXPECT_GT(where_.within_ok(), 0.9);
  unconfirmed_ = 1;
  follow({});
  EXPECT_LE(where_.within_ok(), PoseEstimate::kUnconfirmed);
  run_.drive({{kRound[0].x_m, kRound[0].y_m}, {kRound[0].x_m + 2.0, kRound[0].y_m}});
  follow({});
  EXPECT_LE(where_.within_ok(), PoseEstimate::kUnconfirmed) << "nothing is closed yet";
  run_.drive(kRound);
  follow({});
  EXPECT_GT(where_.within_ok(), 0.9);
  unconfirmed_ = 2;
  follow({});
  EXPECT_LE(where_.within_ok(), PoseEstimate::kUnconfirmed) << "it was lost again";
  unconfirmed_ = 0;
  follow({});
  EXPECT_GT(where_.within_ok(), 0.9) << "and found, or told where it is";
}

TEST_F(FilterThatIsPlaced, IsUncertainUntilThenToWhereItWentOnInTheFirstSubmap) {
  Drive run(ring(18.0, 10.0), {});
  FilterInWorld where(GraphParams{});
  const auto drive = [&](const std::vector<Point2>& way) {
    run.drive(way);
    where.update(run.graph);
    static_cast<void>(where.follow({}, run.odom.back().map_T_scan, 0, 1));
  };
  drive({kRound[0], {kRound[0].x_m + 1.0, kRound[0].y_m}});
  ASSERT_TRUE(run.graph.submaps().empty());
  EXPECT_LE(where.within_ok(), PoseEstimate::kUnconfirmed);
  drive({{kRound[0].x_m + 1.0, kRound[0].y_m}, kRound[1]});
  EXPECT_LE(where.within_ok(), PoseEstimate::kUnconfirmed);
  for (std::size_t leg = 2; leg < 8; ++leg) {
    drive({kRound[(leg - 1) % 4], kRound[leg % 4]});
  }
  EXPECT_GT(where.within_ok(), PoseEstimate::kUnconfirmed);
}

// Other particles survive, though the motions were right.
TEST_F(FilterThatIsPlaced, IsNotFollowedWhereItJumpsByItself) {
  for (const Pose2& jump : {Pose2{0.0, 0.0, 0.4}, Pose2{4.0, 2.0, 0.5}, Pose2{}}) {
    EXPECT_LT(follow(local_T_odom(odom_T_scan() * jump)).distance_m(odom_T_scan()), 1e-9);
  }
}

TEST_F(FilterThatIsPlaced, IsNotFollowedWhereItSlips) {
  Pose2 local_T_scan = odom_T_scan();
  for (int i = 0; i < 10; ++i) {
    local_T_scan = local_T_scan * Pose2{0.2, 0.0, 0.02};
    EXPECT_LT(follow(local_T_odom(local_T_scan)).distance_m(odom_T_scan()), 1e-9);
  }
}

TEST_F(FilterThatIsPlaced, MayHaveDriftedTheMoreTheFartherItIsFromALoopClosure) {
  Drive open(ring(18.0, 10.0), {});
  FilterInWorld where(GraphParams{});
  std::vector<double> drift_m2{-1.0};  // after each leg
  for (std::size_t leg = 1; leg < 8; ++leg) {
    open.drive({kRound[(leg - 1) % 4], kRound[leg % 4]});
    where.update(open.graph);
    static_cast<void>(where.follow({}, open.odom.back().map_T_scan, 0, 0));
    drift_m2.push_back(where.drift().topLeftCorner<2, 2>().trace());
    EXPECT_TRUE(leg >= 4 || drift_m2[leg] > drift_m2[leg - 1]) << "after leg " << leg;
  }
  EXPECT_LT(drift_m2[5], 0.5 * drift_m2[3]) << "the loop is closed";
  EXPECT_LT(drift_m2[7], 1.5 * drift_m2[3]) << "a second round is held by the first one";
}

// Not only when the submap that it is in has ended.
TEST_F(FilterThatIsPlaced, KnowsASlipOfTheLocalMapWithTheNextKeyframe) {
  for (const double metres : {1.0, 9.0}) {  // without any submap, and behind one
    Drive drive(ring(18.0, 10.0), {});
    drive.drive({kRound[0], {kRound[0].x_m + metres, kRound[0].y_m}});
    const double before_m2 = drift_m2(drive);
    drive.map_slip_m2 = 0.09;
    drive.drive({{kRound[0].x_m + metres, kRound[0].y_m}, {kRound[0].x_m + metres + 1.0, kRound[0].y_m}});
    EXPECT_NEAR(drift_m2(drive) - before_m2, 0.09, 0.01) << metres;
    drive.drive({{kRound[0].x_m + metres + 1.0, kRound[0].y_m}, {kRound[0].x_m + metres + 8.0, kRound[0].y_m}});
    const double slip_m2 = metres > 5.0 ? 0.09 : 0.0;  // the map begins where the first submap has its origin
    EXPECT_NEAR(drift_m2(drive) - before_m2, slip_m2, 0.02) << metres << ": and when that submap has ended";
  }
}

TEST_F(FilterThatIsPlaced, KnowsASlipOfTheLocalMapWhereItsPlaceInTheWorldIsAGuess) {
  run_.graph.finish();
  Drive drive(ring(18.0, 10.0), {});
  ASSERT_TRUE(drive.graph.resume(run_.graph.world()));
  drive.drive({{-10.5, 2.0}, {-10.5, -1.0}});
  ASSERT_TRUE(drive.graph.guess());
  const double before_m2 = drift_m2(drive);
  drive.map_slip_m2 = 0.09;
  drive.drive({{-10.5, -1.0}, {-10.5, -2.0}});
  ASSERT_TRUE(drive.graph.guess());
  EXPECT_NEAR(drift_m2(drive) - before_m2, 0.09, 0.01);
}

TEST_F(FilterThatIsPlaced, HasAPlaceForEachPoseOfTheWorld) {
  EXPECT_LT(where_.to_local(odom_T_scan()).distance_m(odom_T_scan()), 0.05);
}

}  // namespace
}  // namespace odoless
