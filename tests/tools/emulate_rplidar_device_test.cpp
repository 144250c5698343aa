// What the emulated RPLIDAR answers, as Slamtec's own SDK asks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/tools/emulate_support.hpp"
#include "tools/emulate/rplidar_device.hpp"

namespace odoless {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

std::string bytes(std::initializer_list<int> values) {
  std::string text;
  for (const int value : values) {
    text += static_cast<char>(value);
  }
  return text;
}

std::string request(int command, std::string_view payload) {
  std::string text = bytes({0xA5, command, static_cast<int>(payload.size())});
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
    const std::string answer = said(request(0x84, bytes({key, 0, 0, 0, mode, 0}) + std::string(30, '\0')));
    EXPECT_THAT(answer, SizeIs(::testing::Ge(11U)));
    const auto length = static_cast<unsigned char>(answer[2]);
    EXPECT_EQ(answer.substr(3, 4), bytes({0, 0, 0, 0x20}));
    EXPECT_EQ(answer.size(), 7U + length);
    EXPECT_EQ(answer.substr(7, 4), bytes({key, 0, 0, 0}));
    return answer.substr(11);
  }

  std::int64_t now_ns_ = test::kSecond;
  RplidarModel model_ = *find_rplidar_model(GetParam());
  WorldSource source_{model_.turn_ns, test::small_drive()};
  RplidarDevice device_{model_, source_, {}};
};

using EmulatedNewRplidar = EmulatedRplidar;
INSTANTIATE_TEST_SUITE_P(Models, EmulatedNewRplidar, ::testing::Values("rplidar-a1", "rplidar-a2"));

// An answer without a value makes a client read what isn't there.
TEST_P(EmulatedNewRplidar, EverySettingThatTheSdkAsksForHasItsValue) {
  const std::string usual = setting(0x01);
  EXPECT_THAT(usual, SizeIs(4)) << "rpm and duty";
  EXPECT_EQ(usual, model_.id == 0x28 ? bytes({600 & 0xFF, 600 >> 8, 660 & 0xFF, 660 >> 8})
                                     : bytes({329 & 0xFF, 329 >> 8, 0, 0}));
  EXPECT_EQ(setting(0x02), bytes({3, 0, 0, 0}));
  EXPECT_THAT(setting(0x04), SizeIs(2));
  EXPECT_THAT(setting(0x05), SizeIs(2));
  EXPECT_THAT(setting(0x60), SizeIs(4));
  EXPECT_EQ(setting(0x70), bytes({2, 0}));
  EXPECT_EQ(setting(0x7C), bytes({1, 0}));
  for (const int mode : {0, 1}) {
    EXPECT_THAT(setting(0x71, mode), SizeIs(4));
    EXPECT_THAT(setting(0x74, mode), SizeIs(4));
    EXPECT_EQ(setting(0x75, mode), bytes({0x81 + mode}));
    EXPECT_EQ(setting(0x7F, mode), std::string(mode == 0 ? "Standard" : "Express") + '\0');
  }
  EXPECT_THAT(setting(0x71, 2), IsEmpty()) << "there is no such mode";
}

TEST_P(EmulatedNewRplidar, StartsTheScanOfItsListAndNoOther) {
  static_cast<void>(said(request(0xF0, bytes({0x94, 0x02}))));
  EXPECT_THAT(said(request(0x82, bytes({2, 0, 0, 0, 0}))), IsEmpty());
  EXPECT_EQ(said(request(0x82, bytes({1, 0, 0, 0, 0}))), bytes({0xA5, 0x5A, 84, 0, 0, 0x40, 0x82}));
}

using EmulatedOldRplidar = EmulatedRplidar;
INSTANTIATE_TEST_SUITE_P(Models, EmulatedOldRplidar, ::testing::Values("rplidar-a1-1.16"));

TEST_P(EmulatedOldRplidar, KnowsNothingThatCameWithLaterFirmware) {
  EXPECT_EQ(said(bytes({0xA5, 0x50})).substr(7, 3), bytes({0x18, 16, 1}));
  EXPECT_THAT(said(request(0x82, bytes({0, 0, 0, 0, 0}))), IsEmpty()) << "the express scan: 1.17";
  EXPECT_THAT(said(bytes({0xA5, 0x59})), IsEmpty()) << "sample times: 1.17";
  EXPECT_THAT(said(request(0x84, bytes({0x70, 0, 0, 0}))), IsEmpty()) << "settings: 1.24";
  EXPECT_THAT(said(bytes({0xA5, 0x20})), StartsWith(bytes({0xA5, 0x5A, 5, 0, 0, 0x40, 0x81})));
}

}  // namespace
}  // namespace odoless
