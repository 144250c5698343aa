#include "core/odometry/laser_odometry.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include "rt/cpu_clock.hpp"
#include "tests/support/simulated_room.hpp"
#include "tests/support/simulated_scene.hpp"

namespace odoless {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr std::int64_t kPeriod_ns = 100'000'000;

// A robot that is driven through a scene and tracked; stamps, true pose and estimate side by side.
class OdometryDrive {
 public:
  explicit OdometryDrive(SimulatedScene scene, const Pose2& map_T_start = {}, const SimulatedLaser& laser = {})
      : scene_(std::move(scene)), laser_(laser), map_T_start_(map_T_start), map_T_scan_(map_T_start) {
    step({}, 0);
  }

  // Moves by `motion` within `period_ns`, then scans.
  const Motion& step(const Pose2& motion, std::int64_t period_ns = kPeriod_ns) {
    return seen(scene_, motion, period_ns);
  }
  // The same while the laser is covered.
  const Motion& step_blind(const Pose2& motion) { return step_in(SimulatedScene{}, motion); }
  // The same in another scene.
  const Motion& step_in(const SimulatedScene& scene, const Pose2& motion) { return seen(scene, motion, kPeriod_ns); }

  [[nodiscard]] Pose2 map_T_scan() const { return map_T_scan_; }
  [[nodiscard]] Pose2 truth() const { return map_T_start_.inverse() * map_T_scan_; }
  [[nodiscard]] Pose2 estimate() const { return last_.odom_T_current; }
  [[nodiscard]] const Motion& last() const { return last_; }

  void expect_on_track(double within_m, double within_rad) const {
    EXPECT_LT(truth().distance_m(estimate()), within_m);
    EXPECT_LT(std::abs(wrap_angle(truth().yaw_rad - estimate().yaw_rad)), within_rad);
  }

 private:
  const Motion& seen(const SimulatedScene& scene, const Pose2& motion, std::int64_t period_ns) {
    map_T_scan_ = map_T_scan_ * motion;
    stamp_ns_ += period_ns;
    ScanFrame scan = sweep(scene, laser_, map_T_scan_, rng_, stamp_ns_);
    last_ = odometry_.process(scan, {}, rng_);
    return last_;
  }

  SimulatedScene scene_;
  SimulatedLaser laser_;
  Pose2 map_T_start_;
  Pose2 map_T_scan_;
  std::int64_t stamp_ns_ = 1'000'000'000;
  LaserOdometry odometry_{{}, {}, {}, {}};
  Rng rng_{1};
  Motion last_;
};

// Straight legs of 1.6 m at 0.8 m/s and turns of 90 deg at 90 deg/s, around the middle of the room.
Pose2 motion_of_square(int step) { return step % 30 < 20 ? Pose2{0.08, 0.0, 0.0} : Pose2{0.0, 0.0, 9.0 * kRadPerDeg}; }

// No scan leaves time for more of a local map than its few sure slices.
TEST(LaserOdometry, LocalMapsThatTakeManyScansToBuildHoldTheTrackToo) {
  const Deadline over([](const void*) { return true; }, nullptr);
  const SimulatedScene room = cluttered_room();
  LaserOdometry odometry({}, {}, {}, {});
  Rng rng(1);
  Pose2 map_T_scan{-0.8, -1.2, 0.0};
  const Pose2 map_T_start = map_T_scan;
  Motion last;
  for (int i = 0; i < 200; ++i) {
    ScanFrame scan = sweep(room, {}, map_T_scan, rng, (i + 1) * kPeriod_ns);
    last = odometry.process(scan, over, rng);
    EXPECT_TRUE(i < 20 || last.matched()) << i;
    const Pose2 truth = map_T_start.inverse() * map_T_scan;
    ASSERT_LT(truth.distance_m(last.odom_T_current), 0.2) << i;
    map_T_scan = map_T_scan * Pose2{0.02 * std::cos(0.03 * i), 0.0, 0.03};
  }
}

TEST(LaserOdometry, TracksStraightLegsAndFastTurns) {
  OdometryDrive drive(cluttered_room(), {-0.8, -1.2, 0.0});
  Pose2 composed;
  for (int i = 0; i < 200; ++i) {
    const Motion& step = drive.step(motion_of_square(i));
    ASSERT_TRUE(step.matched());
    EXPECT_EQ(step.to_stamp_ns - step.from_stamp_ns, kPeriod_ns);
    composed = composed * step.previous_T_current;
    ASSERT_LT(drive.truth().distance_m(drive.estimate()), 0.1) << i;
  }
  drive.expect_on_track(0.05, 0.5 * kRadPerDeg);
  EXPECT_LT(composed.distance_m(drive.estimate()), 1e-9) << "the increments are the track";
}

// A hall of 40 m with boxes along its walls, of which the laser sees a part.
SimulatedScene hall() {
  SimulatedScene scene;
  Rng rng(9);
  scene.add_box({15.0, 0.0, 0.0}, 40.0, 5.0);
  for (int i = 0; i < 40; ++i) {
    scene.add_box({i - 4.0, i % 2 == 0 ? 2.0 : -2.0, rng.uniform(-1.5, 1.5)}, rng.uniform(0.2, 0.8), 0.3);
  }
  return scene;
}

TEST(LaserOdometry, TracksOnWhenNothingOfTheStartIsInSight) {
  OdometryDrive drive(hall(), {}, {.range_max_m = 5.0});
  for (int i = 0; i < 200; ++i) {
    drive.step({0.1, 0.0, 0.02 * std::cos(0.1 * i)});
  }
  EXPECT_GT(drive.truth().x_m, 15.0);
  drive.expect_on_track(0.1, 0.5 * kRadPerDeg);
}

TEST(LaserOdometry, FirstScanIsTheOrigin) {
  const OdometryDrive drive(cluttered_room(), {0.5, 0.5, 2.0});
  EXPECT_FALSE(drive.last().matched());
  EXPECT_EQ(drive.last().from_stamp_ns, drive.last().to_stamp_ns);
  EXPECT_EQ(drive.estimate().x_m, 0.0);
  EXPECT_LT(drive.last().covariance().trace(), 1e-4);
}

TEST(LaserOdometry, TellsHowUncertainTheTimeOfAMotionIs) {
  LaserOdometry odometry({}, {}, {}, {});
  Rng rng(1);
  for (const auto& [time_ns, sd_s, told_s] : {std::tuple(0, 0.03, 0.0), std::tuple(90'000'000, 0.04, 0.05)}) {
    ScanFrame scan = sweep(cluttered_room(), {}, {}, rng, time_ns);
    scan.set_time({.time_ns = time_ns, .sd_s = sd_s});
    EXPECT_NEAR(odometry.process(scan, {}, rng).duration_sd_s, told_s, 1e-9);
  }
}

TEST(LaserOdometry, KeepsTrackAcrossAPauseOfTheData) {
  OdometryDrive drive(cluttered_room(), {-0.8, -1.2, 0.0});
  for (int i = 0; i < 10; ++i) {
    drive.step(motion_of_square(i));
  }
  const Motion& step = drive.step({0.6, 0.1, 50.0 * kRadPerDeg}, 1'000'000'000);
  EXPECT_TRUE(step.matched());
  EXPECT_EQ(step.to_stamp_ns - step.from_stamp_ns, 1'000'000'000);
  drive.expect_on_track(0.03, 0.5 * kRadPerDeg);
  for (int i = 0; i < 10; ++i) {
    drive.step({0.0, 0.0, 9.0 * kRadPerDeg});
  }
  drive.expect_on_track(0.03, 0.5 * kRadPerDeg);
}

TEST(LaserOdometry, BlindScanLeavesThePredictionAndItsUncertainty) {
  OdometryDrive drive(cluttered_room(), {-0.8, -1.2, 0.0});
  for (int i = 0; i < 10; ++i) {
    drive.step(motion_of_square(i));
  }
  const double seen_m2 = drive.last().covariance().trace();
  double foreseen_m = 0.08;  // as fast as before, and with every blind scan less surely so
  for (int i = 0; i < 4; ++i) {
    const Motion& blind = drive.step_blind({0.08, 0.0, 0.0});
    EXPECT_FALSE(blind.matched());
    EXPECT_NEAR(blind.previous_T_current.x_m, foreseen_m, 0.01);
    EXPECT_NEAR(blind.previous_T_current.yaw_rad, 0.0, 0.02);
    EXPECT_GT(blind.covariance().trace(), seen_m2);
    foreseen_m *= 0.5;
  }
  drive.step({0.08, 0.0, 0.0});
  EXPECT_TRUE(drive.step({0.08, 0.0, 0.0}).matched());
  drive.expect_on_track(0.03, 0.5 * kRadPerDeg);
}

TEST(LaserOdometry, BlindStartIsOverWithTheFirstScanThatSees) {
  LaserOdometry odometry({}, {}, {}, {});
  Rng rng(2);
  for (int i = 0; i < 10; ++i) {
    const Pose2 map_T_scan{0.05 * i, 0.0, 0.0};
    ScanFrame scan = sweep(i < 4 ? SimulatedScene{} : cluttered_room(), {}, map_T_scan, rng, i * kPeriod_ns);
    const Motion step = odometry.process(scan, {}, rng);
    EXPECT_EQ(step.matched(), i > 4) << i;
    if (i > 4) {
      EXPECT_NEAR(step.odom_T_current.x_m, 0.05 * (i - 4), 0.025);  // it is taken to stand until it is seen to move
    }
  }
}

TEST(LaserOdometry, LongBlindnessDoesNotEmptyTheLocalMap) {
  OdometryDrive drive(cluttered_room(), {-0.8, -1.2, 0.0});
  for (int i = 0; i < 20; ++i) {
    drive.step({0.0, 0.0, 9.0 * kRadPerDeg});
  }
  for (int i = 0; i < 200; ++i) {
    drive.step_blind({});
  }
  EXPECT_TRUE(drive.step({}).matched());
  for (int i = 0; i < 5; ++i) {
    drive.step({0.0, 0.0, 1.0 * kRadPerDeg});
  }
  drive.expect_on_track(0.05, 0.5 * kRadPerDeg);
}

// The corridor's direction in the axes of the previous scan, and the one across it.
struct CorridorAxes {
  explicit CorridorAxes(double yaw_rad) : along(std::cos(yaw_rad), -std::sin(yaw_rad)), across(-along.y(), along.x()) {}

  [[nodiscard]] double ratio_of_variances(const Eigen::Matrix3d& covariance) const {
    const Eigen::Matrix2d translation_m2 = covariance.topLeftCorner<2, 2>();
    return along.dot(translation_m2 * along) / across.dot(translation_m2 * across);
  }

  Eigen::Vector2d along;
  Eigen::Vector2d across;
};

TEST(LaserOdometry, CorridorIsTrackedAcrossAndCalledWeakAlong) {
  OdometryDrive drive(corridor(), {0.0, 0.1, 0.0}, {.range_max_m = 8.0});
  for (int i = 0; i < 20; ++i) {
    const Motion& step = drive.step({0.1, 0.0, 0.01}, 2 * kPeriod_ns);
    const CorridorAxes axes(0.01 * i);
    ASSERT_TRUE(step.matched());
    EXPECT_GT(axes.ratio_of_variances(step.covariance()), 1.0);
    EXPECT_LT(step.weak_information_1_m2, 20.0);
    EXPECT_NEAR(drive.truth().y_m, drive.estimate().y_m, 0.02);
    EXPECT_NEAR(drive.truth().yaw_rad, drive.estimate().yaw_rad, 0.5 * kRadPerDeg);
  }
}

// Errors of a step over the deviations that it states, along and across the corridor, squared.
struct SquaredErrors {
  SquaredErrors(const Motion& step, const Pose2& motion, const CorridorAxes& axes) {
    const Eigen::Vector2d error(step.previous_T_current.x_m - motion.x_m, step.previous_T_current.y_m - motion.y_m);
    const Eigen::Matrix2d covariance = step.covariance().topLeftCorner<2, 2>();
    along = std::pow(axes.along.dot(error), 2) / axes.along.dot(covariance * axes.along);
    across = std::pow(axes.across.dot(error), 2) / axes.across.dot(covariance * axes.across);
  }
  double along = 0.0;
  double across = 0.0;
};

// The speed changes as the robot likes, by less than the acceleration that is expected of it. Unseen changes add up, so
// that the errors are somewhat larger than the deviations of one step.
TEST(LaserOdometry, ErrorsInACorridorAreWithinTwoStatedDeviations) {
  Rng rng(3);
  for (const double heading_rad : {0.0, 0.4, -1.2}) {
    OdometryDrive drive(corridor(), {-10.0, 0.1, heading_rad}, {.range_max_m = 8.0});
    const CorridorAxes axes(heading_rad);
    double along = 0.0;
    double across = 0.0;
    double speed_mps = 0.5;
    constexpr int kSteps = 150;
    for (int i = 0; i < kSteps; ++i) {
      speed_mps = std::clamp(speed_mps + 0.2 * rng.normal(), 0.0, 1.0);
      const double travel_m = speed_mps * 0.2;
      const Pose2 motion{travel_m * axes.along.x(), travel_m * axes.along.y(), 0.0};
      const SquaredErrors errors(drive.step(motion, 2 * kPeriod_ns), motion, axes);
      along += errors.along / kSteps;
      across += errors.across / kSteps;
      ASSERT_LT(errors.along, 5.0 * 5.0) << i;
    }
    EXPECT_LT(along, 2.0 * 2.0);
    EXPECT_GT(along, 0.02) << "not doubtful beyond reason";
    EXPECT_LT(across, 1.5);
  }
}

// Between its ends nothing tells how far the robot goes, and what it sees of the second end does not tell it later.
TEST(LaserOdometry, SaysWhatItsMapMayHaveSlippedByWhereACorridorEnds) {
  SimulatedScene closed;
  closed.add_box({3.0, 0.0, 0.0}, 10.0, 2.0);
  const double heading_rad = 0.5;  // of the robot: it drives sideways
  OdometryDrive drive(closed, {0.0, 0.1, heading_rad}, {.range_max_m = 4.0});
  const Pose2 step{0.05 * std::cos(heading_rad), -0.05 * std::sin(heading_rad), 0.0};
  Motion before = drive.last();
  while (drive.map_T_scan().x_m < 3.5) {
    before = before.then(drive.step(step));
  }
  Motion at_end = drive.step(step);
  while (drive.map_T_scan().x_m < 6.0) {
    at_end = at_end.then(drive.step(step));
  }
  const Eigen::Vector2d along(std::cos(heading_rad), -std::sin(heading_rad));
  EXPECT_LT(matrix_of<2>(before.map_slip).trace(), 0.05 * 0.05);
  const Eigen::Matrix2d slip = matrix_of<2>(at_end.map_slip);
  EXPECT_GT(along.dot(slip * along), 0.2 * 0.2);
  EXPECT_LT(slip.trace() - along.dot(slip * along), 0.05 * 0.05) << "not across";
}

TEST(LaserOdometry, ItsMapSlipsInNoRoom) {
  OdometryDrive drive(cluttered_room(), {-0.8, -1.2, 0.0});
  Motion all = drive.last();
  for (int i = 0; i < 100; ++i) {
    all = all.then(drive.step(motion_of_square(i)));
  }
  EXPECT_LT(matrix_of<2>(all.map_slip).trace(), 0.05 * 0.05);
}

// A turn ends just where others hide most of the room: what little is left to match tells more of it than the speed.
TEST(LaserOdometry, AJoltedScanTellsMoreThanTheSpeedWhereATurnMayHaveEnded) {
  OdometryDrive drive(cluttered_room(), {-0.8, -1.2, 0.0});
  for (int i = 0; i < 60; ++i) {
    drive.step(motion_of_square(i));
  }
  SimulatedScene crowded = cluttered_room();
  for (int i = 0; i < 13; ++i) {
    const Pose2 map_T_person =
        drive.map_T_scan() * Pose2{0.0, 0.0, 0.35 * (i - 5)} * Pose2{0.9 + 0.1 * (i % 3), 0.0, 0.0};
    crowded.add_box(map_T_person, 0.3, 0.3);
  }
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(drive.step_in(crowded, {}).has(kJolted)) << i;
    drive.expect_on_track(0.1, 2.0 * kRadPerDeg);
  }
}

// Where it was carried to, nothing is as before: what the first match makes of it is neither a speed nor a place.
// Until the local map begins anew nothing is there to be matched: the speed of before is kept.
TEST(LaserOdometry, CarriedIntoAnotherSceneTracksOnThereAfterThreeScans) {
  OdometryDrive drive(cluttered_room(), {-0.8, -1.2, 0.0});
  for (int i = 0; i < 60; ++i) {
    EXPECT_FALSE(drive.step(motion_of_square(i)).has(kJolted)) << i;
  }
  EXPECT_TRUE(drive.step_in(pillar_field(), motion_of_square(60)).has(kJolted));
  for (int i = 61; i < 90; ++i) {  // a leg and a turn
    const Pose2 motion = motion_of_square(i);
    const Motion& step = drive.step_in(pillar_field(), motion);
    if (i < 60 + LaserOdometryParams{}.poor_scans) {
      EXPECT_TRUE(step.has(kJolted)) << i;
      continue;
    }
    ASSERT_LT(step.previous_T_current.distance_m(motion), 0.06) << i;
    ASSERT_LT(std::abs(wrap_angle(step.previous_T_current.yaw_rad - motion.yaw_rad)), 3.0 * kRadPerDeg) << i;
  }
}

TEST(LaserOdometry, RecoversFromEqualAndBackwardStamps) {
  OdometryDrive drive(cluttered_room(), {-0.8, -1.2, 0.0});
  for (int i = 0; i < 20; ++i) {
    drive.step(motion_of_square(i), i % 3 == 0 ? 0 : (i % 3 == 1 ? -kPeriod_ns : 3 * kPeriod_ns));
    ASSERT_LT(drive.truth().distance_m(drive.estimate()), 0.5);
  }
  for (int i = 0; i < 20; ++i) {
    drive.step({0.0, 0.0, 4.5 * kRadPerDeg});
  }
  drive.expect_on_track(0.05, 0.5 * kRadPerDeg);
}

/// How a thread spent a scan: the longest time that it did not ask whether its time is over.
struct Spent {
  std::int64_t begin_ns = thread_cpu_ns();
  std::int64_t asked_ns = begin_ns;
  std::int64_t longest_ns = 0;

  void ask() {
    const std::int64_t now_ns = thread_cpu_ns();
    longest_ns = std::max(longest_ns, now_ns - asked_ns);
    asked_ns = now_ns;
  }
  [[nodiscard]] Deadline endless() {
    return {[](const void* context) {
              const_cast<Spent*>(static_cast<const Spent*>(context))->ask();
              return false;
            },
            this};
  }
};

std::int64_t median(std::vector<std::int64_t> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

TEST(LaserOdometry, MakesItsLocalMapInSlicesAndAsksBetweenThem) {
  LaserOdometryParams params;
  params.key_distance_m = 0.0;                 // each scan is a key scan,
  params.local_map.fine = {0.01, 40.0, 0.05};  // and a local map takes much longer to make than a match
  LaserOdometry odometry(params, {}, {}, {});
  SimulatedRoom room(1, 400);
  Rng rng(1);
  std::vector<std::int64_t> longest_ns;
  std::vector<std::int64_t> all_ns;
  for (int i = 0; i < 20; ++i) {
    room.step();
    Spent spent;
    ScanFrame scan = room.scan();
    const Motion step = odometry.process(scan, spent.endless(), rng);
    if (i > 0) {
      ASSERT_TRUE(step.matched());
      spent.ask();
      longest_ns.push_back(spent.longest_ns);
      all_ns.push_back(spent.asked_ns - spent.begin_ns);
    }
  }
  EXPECT_LT(10 * median(longest_ns), median(all_ns));
}

}  // namespace
}  // namespace odoless
