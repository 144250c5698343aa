// What the emulated RPLIDAR answers, as Slamtec's own SDK asks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/tools/emulate_support.hpp"
#include "tools/emulate/rplidar_device.hpp"

namespace odoless {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

std::string rplidar_bytes(std::initializer_list<int> values) {
  std::string text;
  for (const int value : values) {
    text += static_cast<char>(value);
  }
  return text;
}

std::string number(unsigned value, int bytes) {
  std::string text;
  for (; bytes > 0; --bytes, value >>= 8U) {
    text += static_cast<char>(value & 0xFFU);
  }
  return text;
}

std::string request(int command, std::string_view payload) {
  std::string text = rplidar_bytes({0xA5, command, static_cast<int>(payload.size())});
  text += payload;
  int sum = 0;
  for (const char c : text) {
    sum ^= static_cast<unsigned char>(c);
  }
  return text + static_cast<char>(sum);
}

class EmulatedRplidar : public ::testing::TestWithParam<const char*> {
 protected:
  std::string said(const std::string& asked) {
    device_.receive(asked, now_ns_);
    std::string all;
    for (const SentBytes& sent : device_.take_output()) {
      all += sent.bytes;
    }
    return all;
  }
  /// The value of a setting as the SDK asks for it: key and mode, and 32 bytes for what may come.
  std::string setting(int key, int mode = 0) {
    const std::string answer = said(request(0x84, rplidar_bytes({key, 0, 0, 0, mode, 0}) + std::string(30, '\0')));
    EXPECT_THAT(answer, SizeIs(::testing::Ge(11U)));
    const auto length = static_cast<unsigned char>(answer[2]);
    EXPECT_EQ(answer.substr(3, 4), rplidar_bytes({0, 0, 0, 0x20}));
    EXPECT_EQ(answer.size(), 7U + length);
    EXPECT_EQ(answer.substr(7, 4), rplidar_bytes({key, 0, 0, 0}));
    return answer.substr(11);
  }

  std::int64_t now_ns_ = test::kSecond;
  RplidarModel model_ = *find_rplidar_model(GetParam());
  WorldSource source_{model_.turn_ns, test::small_drive()};
  RplidarDevice device_{model_, source_, {}};
};

using EmulatedNewRplidar = EmulatedRplidar;
INSTANTIATE_TEST_SUITE_P(Models, EmulatedNewRplidar,
                         ::testing::Values("rplidar-a1", "rplidar-a2", "rplidar-a3", "rplidar-c1", "rplidar-s1",
                                           "rplidar-s2", "rplidar-s3"));

// An answer without a value makes a client read what isn't there.
TEST_P(EmulatedNewRplidar, EverySettingThatTheSdkAsksForHasItsValue) {
  EXPECT_EQ(setting(0x01),
            number(static_cast<unsigned>(model_.usual_rpm()), 2) + number(static_cast<unsigned>(model_.motor_duty), 2))
      << "rpm and duty";
  EXPECT_EQ(setting(0x02), number((1U << model_.modes.size()) - 1U, 4));
  EXPECT_THAT(setting(0x04), SizeIs(2));
  EXPECT_THAT(setting(0x05), SizeIs(2));
  EXPECT_THAT(setting(0x60), SizeIs(4));
  EXPECT_EQ(setting(0x70), number(static_cast<unsigned>(model_.modes.size()), 2));
  EXPECT_EQ(setting(0x7C), number(static_cast<unsigned>(model_.usual_mode), 2));
  for (std::size_t i = 0; i < model_.modes.size(); ++i) {
    const RplidarMode& mode = model_.modes[i];
    const int id = static_cast<int>(i);
    EXPECT_EQ(setting(0x71, id), number(static_cast<unsigned>(std::lround(256.0 * mode.sample_us)), 4));
    EXPECT_EQ(setting(0x74, id), number(static_cast<unsigned>(256.0 * mode.range_max_m), 4));
    EXPECT_EQ(setting(0x75, id), number(static_cast<unsigned>(mode.answer_type), 1));
    EXPECT_EQ(setting(0x7F, id), std::string(mode.name) + '\0');
  }
  EXPECT_THAT(setting(0x71, static_cast<int>(model_.modes.size())), IsEmpty()) << "there is no such mode";
}

TEST_P(EmulatedNewRplidar, StartsTheScansOfItsListAndNoOther) {
  static_cast<void>(said(request(0xF0, rplidar_bytes({0x94, 0x02}))));
  for (std::size_t i = 1; i < model_.modes.size(); ++i) {
    const rplidar::CapsuleFormat& format = *rplidar::find_capsule_format(model_.modes[i].answer_type);
    EXPECT_EQ(said(request(0x82, rplidar_bytes({static_cast<int>(i), 0, 0, 0, 0}))),
              rplidar_bytes({0xA5, 0x5A, static_cast<int>(format.bytes), 0, 0, 0x40, format.type}));
    static_cast<void>(said(rplidar_bytes({0xA5, 0x25})));
  }
  EXPECT_THAT(said(request(0x82, rplidar_bytes({static_cast<int>(model_.modes.size()), 0, 0, 0, 0}))), IsEmpty());
}

// Owners' logs of an A1 (7.9 kHz by Sensitivity), an A2 (8.0 by Boost), an A3 (15.9), a C1 (5), an S1 (9.2), an S2
// (32).
TEST(EmulatedRplidars, TellTheFiguresThatOwnersPublished) {
  const auto usual_khz = [](std::string_view name) {
    const RplidarModel& model = *find_rplidar_model(name);
    return 1000.0 / model.modes[model.usual_mode].sample_us;
  };
  EXPECT_NEAR(usual_khz("rplidar-a1"), 7.9, 0.05);
  EXPECT_NEAR(usual_khz("rplidar-a2"), 8.0, 0.05);
  EXPECT_NEAR(usual_khz("rplidar-a3"), 15.9, 0.05);
  EXPECT_NEAR(usual_khz("rplidar-c1"), 5.0, 0.05);
  EXPECT_NEAR(usual_khz("rplidar-s1"), 9.2, 0.05);
  EXPECT_NEAR(usual_khz("rplidar-s2"), 32.0, 0.05);
  for (const RplidarModel& model : rplidar_models()) {
    for (const RplidarMode& mode : model.modes) {
      const rplidar::CapsuleFormat* const format = rplidar::find_capsule_format(mode.answer_type);
      const double sample_bytes =
          format == nullptr ? 5.0 : static_cast<double>(format->bytes) / static_cast<double>(format->points);
      EXPECT_LT(10.0 * sample_bytes * 1e6 / mode.sample_us, model.baud) << model.name << " " << mode.name;
    }
  }
}

using EmulatedOldRplidar = EmulatedRplidar;
INSTANTIATE_TEST_SUITE_P(Models, EmulatedOldRplidar, ::testing::Values("rplidar-a1-1.16"));

TEST_P(EmulatedOldRplidar, KnowsNothingThatCameWithLaterFirmware) {
  EXPECT_EQ(said(rplidar_bytes({0xA5, 0x50})).substr(7, 3), rplidar_bytes({0x18, 16, 1}));
  EXPECT_THAT(said(request(0x82, rplidar_bytes({0, 0, 0, 0, 0}))), IsEmpty()) << "the express scan: 1.17";
  EXPECT_THAT(said(rplidar_bytes({0xA5, 0x59})), IsEmpty()) << "sample times: 1.17";
  EXPECT_THAT(said(request(0x84, rplidar_bytes({0x70, 0, 0, 0}))), IsEmpty()) << "settings: 1.24";
  EXPECT_THAT(said(rplidar_bytes({0xA5, 0x20})), StartsWith(rplidar_bytes({0xA5, 0x5A, 5, 0, 0, 0x40, 0x81})));
}

}  // namespace
}  // namespace odoless
