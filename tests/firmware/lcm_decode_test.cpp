#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

#include "core/base/rng.hpp"
#include "firmware/lcm/decode.hpp"
#include "firmware/lcm/messages.hpp"
#include "tests/firmware/lcm_decode_contract.hpp"
#include "tests/firmware/lcm_records.hpp"

namespace odoless {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kDenormal = std::numeric_limits<double>::denorm_min();

template <class Message>
std::vector<std::byte> encoded(const Message& message) {
  std::vector<std::byte> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  EXPECT_EQ(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  return bytes;
}

motion_t message_of(const Motion& motion) {
  motion_t message;
  to_message(motion, message);
  return message;
}

bot_core::planar_lidar_t example_lidar(int beams) {
  bot_core::planar_lidar_t message;
  to_message(test::example_scan(beams), test::example_ranges_m(beams), message);
  return message;
}

double arbitrary_real(double magnitude) {
  const auto share = static_cast<double>(*rc::gen::arbitrary<std::int32_t>()) * 0x1p-31;
  return share * magnitude;
}

Pose2 arbitrary_pose() { return {arbitrary_real(1000.0), arbitrary_real(1000.0), arbitrary_real(M_PI)}; }

MatrixRows<3> arbitrary_covariance() {
  MatrixRows<3> covariance{};
  for (std::size_t i = 0; i < covariance.size(); ++i) {
    covariance[i] = i % 4 == 0 ? std::abs(arbitrary_real(1.0)) : arbitrary_real(0.1);
  }
  return covariance;
}

MatrixRows<5> arbitrary_matrix() {
  MatrixRows<5> matrix{};
  for (std::size_t i = 0; i < matrix.size(); ++i) {
    matrix[i] = i % 6 == 0 ? std::abs(arbitrary_real(1.0)) : arbitrary_real(0.1);
  }
  return matrix;
}

Motion arbitrary_motion() {
  const auto from_stamp_ns = *rc::gen::inRange<std::int64_t>(0, 2'000'000'000'000'000) * 1000;
  const auto to_stamp_ns = from_stamp_ns + *rc::gen::inRange<std::int64_t>(0, 1'000'000) * 1000;
  Motion motion = Motion::between(from_stamp_ns, to_stamp_ns, arbitrary_pose());
  motion.duration_ns = *rc::gen::inRange<std::int64_t>(0, 1'000'000'000'000);
  motion.duration_sd_s = std::abs(arbitrary_real(1.0));
  motion.odom_T_current = arbitrary_pose();
  motion.error_initial = arbitrary_matrix();
  motion.error_transition = arbitrary_matrix();
  motion.error_noise = arbitrary_matrix();
  constexpr double kVarianceMax_m2 = 2048.0;  // above it there is no room for a slip's digits, says Motion
  const Eigen::Vector2d slip_m2(std::abs(arbitrary_real(1.0)), std::abs(arbitrary_real(1.0)));
  if (motion.covariance().topLeftCorner<2, 2>().trace() < kVarianceMax_m2) {
    motion.set_map_slip(slip_m2.asDiagonal());
  }
  motion.fitness = std::abs(arbitrary_real(1.0));
  motion.score = arbitrary_real(1.0);
  motion.second_peak_ratio = std::abs(arbitrary_real(1.0));
  motion.strong_information_1_m2 = arbitrary_real(1e4);
  motion.weak_information_1_m2 = arbitrary_real(1.0);
  motion.log_weight = arbitrary_real(10.0);
  motion.alternative_count = *rc::gen::inRange(0, 5);
  for (std::int32_t i = 0; i < motion.alternative_count; ++i) {
    motion.alternatives[static_cast<std::size_t>(i)] = {arbitrary_pose(), arbitrary_real(10.0), arbitrary_covariance()};
  }
  motion.evaluations = *rc::gen::inRange(0, 100'000);
  motion.steps = *rc::gen::inRange(1, 1000);
  motion.flags = *rc::gen::inRange<std::uint32_t>(0, kMotionFlags + 1);
  return motion;
}

bool is_same(const Motion& a, const Motion& b) { return std::memcmp(&a, &b, sizeof(Motion)) == 0; }

// Compared as bytes: -0 is not 0. A Motion has no padding.
TEST(DecodeMotion, GivesEveryBitBack) {
  EXPECT_TRUE(rc::check([] {
    const Motion motion = arbitrary_motion();
    const Result<Motion> decoded = decode_motion(encoded(message_of(motion)));
    RC_ASSERT(decoded.ok());
    RC_ASSERT(is_same(decoded.value(), motion));
  }));
}

// Whatever field a bit is of, and whatever fields there will be: what is changed arrives changed, or is refused.
TEST(DecodeMotion, GivesEveryBitOfEveryFieldBack) {
  constexpr std::size_t kStampsBytes = 2 * sizeof(std::int64_t);  // of whole microseconds: see above
  const Motion motion = test::example_motion();
  ASSERT_EQ(motion.alternative_count, static_cast<int>(Motion::kAlternativesMax));
  std::size_t accepted = 0;
  for (std::size_t byte = kStampsBytes; byte < sizeof(Motion); ++byte) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      std::array<unsigned char, sizeof(Motion)> bytes;
      std::memcpy(bytes.data(), &motion, sizeof(Motion));
      bytes[byte] = static_cast<unsigned char>(bytes[byte] ^ (1U << bit));
      Motion changed;
      std::memcpy(&changed, bytes.data(), sizeof(Motion));
      if (changed.alternative_count != motion.alternative_count) {
        continue;  // those beyond the count are not sent
      }
      changed.set_map_slip(matrix_of<2>(changed.map_slip));  // no other slips are there
      const Result<Motion> decoded = decode_motion(encoded(message_of(changed)));
      if (decoded.ok()) {
        ASSERT_TRUE(is_same(decoded.value(), changed)) << "byte " << byte << ", bit " << bit;
        ++accepted;
      }
    }
  }
  EXPECT_GT(accepted, 6 * sizeof(Motion)) << "most bits are no worse the other way round";
}

TEST(DecodeMotion, RefusesThePoseInTheMap) {
  pose_estimate_t message;
  to_message(test::example_pose(), message);
  EXPECT_EQ(decode_motion(encoded(message)).error(), Errc::kUnknownType);
}

TEST(DecodeMotion, RefusesEveryNumberThatIsNone) {
  const motion_t good = message_of(test::example_motion());
  ASSERT_TRUE(decode_motion(encoded(good)).ok());
  const auto refuses = [&good](auto change) {
    for (const double bad : {kNan, kInfinity, -kInfinity, kDenormal, -kDenormal}) {
      motion_t message = good;
      change(message, bad);
      EXPECT_EQ(decode_motion(encoded(message)).error(), Errc::kBadNumber) << bad;
    }
  };
  for (std::size_t i = 0; i < 3; ++i) {
    refuses([i](motion_t& message, double bad) { message.pose[i] = bad; });
    refuses([i](motion_t& message, double bad) { message.step[i] = bad; });
    refuses([i](motion_t& message, double bad) { message.alternatives[i].step[i] = bad; });
  }
  for (std::size_t i = 0; i < 9; ++i) {
    refuses([i](motion_t& message, double bad) { message.alternatives[3].covariance[i] = bad; });
  }
  for (std::size_t i = 0; i < 2; ++i) {
    refuses([i](motion_t& message, double bad) { message.information[i] = bad; });
  }
  refuses([](motion_t& message, double bad) { message.duration_sd = bad; });
  refuses([](motion_t& message, double bad) { message.fitness = bad; });
  refuses([](motion_t& message, double bad) { message.score = bad; });
  refuses([](motion_t& message, double bad) { message.second_peak_ratio = bad; });
  refuses([](motion_t& message, double bad) { message.log_weight = bad; });
  refuses([](motion_t& message, double bad) { message.alternatives[2].log_weight = bad; });
}

TEST(DecodeMotion, RefusesWhatNoRobotDoes) {
  const auto error_of = [](auto change) {
    motion_t message = message_of(test::example_motion());
    change(message);
    return decode_motion(encoded(message)).error();
  };
  EXPECT_EQ(error_of([](auto& m) { m.utime = -1; }), Errc::kBadNumber);
  EXPECT_EQ(error_of([](auto& m) { m.utime = INT64_MAX; }), Errc::kBadNumber);
  EXPECT_EQ(error_of([](auto& m) { m.reference_utime = m.utime + 1; }), Errc::kBadNumber);
  EXPECT_EQ(error_of([](auto& m) { m.duration_ns = -1; }), Errc::kBadNumber);
  EXPECT_EQ(error_of([](auto& m) { m.duration_ns = INT64_MAX; }), Errc::kBadNumber);
  EXPECT_EQ(error_of([](auto& m) { m.duration_sd = -1e-9; }), Errc::kBadNumber);
  EXPECT_EQ(error_of([](auto& m) { m.alternatives[1].covariance[4] = -1e-9; }), Errc::kBadNumber);
  EXPECT_EQ(error_of([](auto& m) { m.error_initial[6] = -1e-9; }), Errc::kBadNumber);
  EXPECT_EQ(error_of([](auto& m) { m.error_noise[12] = -1e-9; }), Errc::kBadNumber);
  EXPECT_EQ(error_of([](auto& m) { m.evaluations = -1; }), Errc::kBadNumber);
  EXPECT_EQ(error_of([](auto& m) { m.steps = 0; }), Errc::kBadNumber) << "a motion of nothing would not compose";
  EXPECT_EQ(error_of([](auto& m) { m.flags = 1 << 20; }), Errc::kBadNumber);
  EXPECT_EQ(error_of([](auto& m) { m.log_weight = 1e7; }), Errc::kBadNumber);
  EXPECT_EQ(error_of([](auto& m) { m.alternatives.resize(m.alternative_count = 5); }), Errc::kTooLong);
  for (std::size_t i = 0; i < 25; ++i) {
    for (const double bad : {kNan, kInfinity, -kInfinity, 1e13}) {
      EXPECT_EQ(error_of([=](auto& m) { m.error_initial[i] = bad; }), Errc::kBadNumber) << i;
    }
    for (const double bad : {kNan, kInfinity, -kInfinity, 1e7}) {
      EXPECT_EQ(error_of([=](auto& m) { m.error_transition[i] = bad; }), Errc::kBadNumber) << i;
      EXPECT_EQ(error_of([=](auto& m) { m.error_noise[i] = bad; }), Errc::kBadNumber) << i;
    }
  }
  EXPECT_EQ(error_of([](auto& m) { m.fitness = -0.1; }), Errc::kBadNumber);
  EXPECT_EQ(error_of([](auto& m) { m.pose[0] = 1e7; }), Errc::kBadNumber);
  EXPECT_EQ(error_of([](auto& m) { m.step[2] = 13.0; }), Errc::kBadNumber);
}

TEST(DecodeScan, GivesEveryRangeBack) {
  const std::vector<float> ranges_m = test::example_ranges_m(1081);
  std::vector<float> room(1081);
  const Result<RawScan> scan = decode_scan(encoded(example_lidar(1081)), room);
  ASSERT_TRUE(scan.ok());
  EXPECT_EQ(scan.value().stamp_ns, test::example_scan(1).stamp_ns);
  EXPECT_EQ(scan.value().start_angle_rad, test::example_scan(1).start_angle_rad);
  EXPECT_EQ(scan.value().angle_step_rad, test::example_scan(1).angle_step_rad);
  EXPECT_TRUE(std::equal(scan.value().ranges_m.begin(), scan.value().ranges_m.end(), ranges_m.begin(), ranges_m.end()));
}

TEST(DecodeScan, TakesWhatIsNoRangeForAnUnknownOne) {
  auto message = example_lidar(6);
  const float denormal = std::numeric_limits<float>::denorm_min();
  message.ranges = {std::nanf(""), -1.0F,
                    denormal,      -std::numeric_limits<float>::infinity(),
                    1.5F,          std::numeric_limits<float>::infinity()};
  std::vector<float> room(6);
  ASSERT_TRUE(decode_scan(encoded(message), room).ok());
  EXPECT_EQ(room, (std::vector<float>{0.0F, 0.0F, 0.0F, 0.0F, 1.5F, std::numeric_limits<float>::infinity()}));
}

TEST(DecodeScan, SkipsIntensities) {
  auto message = example_lidar(5);
  message.nintensities = 5;
  message.intensities = {1.0F, 2.0F, 3.0F, 4.0F, 5.0F};
  std::vector<float> room(5);
  const Result<RawScan> scan = decode_scan(encoded(message), room);
  ASSERT_TRUE(scan.ok());
  EXPECT_EQ(scan.value().angle_step_rad, test::example_scan(1).angle_step_rad);
  message.nintensities = 4;
  message.intensities.resize(4);
  EXPECT_EQ(decode_scan(encoded(message), room).error(), Errc::kMalformed);
}

TEST(DecodeScan, RefusesMoreBeamsThanThereIsRoomFor) {
  std::vector<float> room(99);
  EXPECT_EQ(decode_scan(encoded(example_lidar(100)), room).error(), Errc::kTooLong);
  EXPECT_TRUE(decode_scan(encoded(example_lidar(99)), room).ok());
}

TEST(DecodeScan, RefusesAGeometryThatIsNone) {
  std::vector<float> room(1081);
  const auto error_of = [&room](float start_angle_rad, float angle_step_rad) {
    auto message = example_lidar(1081);
    message.rad0 = start_angle_rad;
    message.radstep = angle_step_rad;
    return decode_scan(encoded(message), room).error();
  };
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(error_of(std::nanf(""), 0.004F), Errc::kBadNumber);
  EXPECT_EQ(error_of(infinity, 0.004F), Errc::kBadNumber);
  EXPECT_EQ(error_of(std::numeric_limits<float>::denorm_min(), 0.004F), Errc::kBadNumber);
  EXPECT_EQ(error_of(20.0F, 0.004F), Errc::kBadNumber);
  EXPECT_EQ(error_of(0.0F, 0.0F), Errc::kBadNumber);
  EXPECT_EQ(error_of(0.0F, std::nanf("")), Errc::kBadNumber);
  EXPECT_EQ(error_of(0.0F, 0.006F), Errc::kBadNumber);  // more than a full turn
  EXPECT_EQ(error_of(0.0F, -0.004F), Errc::kOk);        // clockwise
}

scan_times_t example_times() {
  ScanRecord scan = test::example_scan(1);
  scan.beam_period_ns = 25'000;
  scan_times_t message;
  to_message(scan, message);
  return message;
}

TEST(DecodeScanTimes, GivesThemBackAndRefusesTimesOfNoScan) {
  scan_times_t message = example_times();
  EXPECT_EQ(message.utime, 1'700'000'000'123'456);
  message.first_beam_ns = -7;
  const Result<ScanTimes> times = decode_scan_times(encoded(message));
  ASSERT_TRUE(times.ok());
  EXPECT_EQ(times.value().first_beam_ns, -7);
  EXPECT_EQ(times.value().beam_period_ns, 25'000);
  for (const std::int64_t bad_ns : {INT64_MIN, std::int64_t{-1'000'000'001}, std::int64_t{1'000'000'001}, INT64_MAX}) {
    message = example_times();
    message.first_beam_ns = bad_ns;
    EXPECT_EQ(decode_scan_times(encoded(message)).error(), Errc::kBadNumber) << bad_ns;
    message = example_times();
    message.beam_period_ns = bad_ns;
    EXPECT_EQ(decode_scan_times(encoded(message)).error(), Errc::kBadNumber) << bad_ns;
  }
  message = example_times();
  message.utime = -1;
  EXPECT_EQ(decode_scan_times(encoded(message)).error(), Errc::kBadNumber);
}

TEST(Decoders, RefuseEachOthersMessages) {
  std::vector<float> room(100);
  EXPECT_EQ(decode_scan(encoded(example_times()), room).error(), Errc::kUnknownType);
  EXPECT_EQ(decode_scan_times(encoded(example_lidar(100))).error(), Errc::kUnknownType);
  EXPECT_EQ(decode_scan(encoded(message_of(test::example_motion())), room).error(), Errc::kUnknownType);
  EXPECT_EQ(decode_motion(encoded(example_lidar(100))).error(), Errc::kUnknownType);
}

TEST(Decoders, RefuseAMessageThatIsCutOrTooLong) {
  std::vector<float> room(20);
  std::vector<std::byte> scan = encoded(example_lidar(20));
  for (std::size_t i = 0; i < scan.size(); ++i) {
    EXPECT_EQ(decode_scan(std::span(scan).first(i), room).error(), Errc::kMalformed) << i;
  }
  scan.push_back(std::byte{0});
  EXPECT_EQ(decode_scan(scan, room).error(), Errc::kMalformed);
  std::vector<std::byte> times = encoded(example_times());
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_EQ(decode_scan_times(std::span(times).first(i)).error(), Errc::kMalformed) << i;
  }
  times.push_back(std::byte{0});
  EXPECT_EQ(decode_scan_times(times).error(), Errc::kMalformed);
  std::vector<std::byte> motion = encoded(message_of(test::example_motion()));
  for (std::size_t i = 0; i < motion.size(); ++i) {
    EXPECT_EQ(decode_motion(std::span(motion).first(i)).error(), Errc::kMalformed) << i;
  }
  motion.push_back(std::byte{0});
  EXPECT_EQ(decode_motion(motion).error(), Errc::kMalformed);
}

// One to four bytes changed anywhere: what is accepted is sane, and every reason to refuse is seen.
TEST(Decoders, AcceptOnlySaneRecordsFromMutatedMessages) {
  const std::array<std::vector<std::byte>, 3> messages{
      encoded(example_lidar(40)), encoded(message_of(test::example_motion())), encoded(example_times())};
  Rng rng(1);
  std::set<Errc> seen;
  for (int i = 0; i < 100'000; ++i) {
    std::vector<std::byte> message = messages[rng.below(3)];
    const std::uint32_t changes = 1 + rng.below(4);
    for (std::uint32_t change = 0; change < changes; ++change) {
      const auto at = rng.below(static_cast<std::uint32_t>(message.size()));
      message[rng.below(2) == 0 ? at : at % 40] = static_cast<std::byte>(rng.below(256));
    }
    seen.insert(test::decode_any(message));
  }
  EXPECT_EQ(seen, (std::set<Errc>{Errc::kOk, Errc::kTooLong, Errc::kMalformed, Errc::kUnknownType, Errc::kBadNumber}));
}

}  // namespace
}  // namespace odoless
