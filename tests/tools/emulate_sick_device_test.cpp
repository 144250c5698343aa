// What the emulated SICK answers and sends, as another client than ours asks it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "drivers/lrf/sick/telegram.hpp"
#include "tests/tools/emulate_support.hpp"
#include "tools/emulate/sick_device.hpp"

namespace odoless {
namespace {

using test::kMs;
using test::kSecond;
using ::testing::IsEmpty;
using ::testing::StartsWith;

std::string bytes(std::initializer_list<int> values) {
  std::string text;
  for (const int value : values) {
    text += static_cast<char>(value);
  }
  return text;
}

unsigned number(const std::string& text, std::size_t at) {
  return static_cast<unsigned char>(text.at(at)) + 256U * static_cast<unsigned char>(text.at(at + 1));
}

class EmulatedSick : public ::testing::Test {
 protected:
  explicit EmulatedSick(const char* model = "lms291") : model_(*find_sick_model(model)) {}

  /// Payloads of the telegrams that come within that time, status included.
  std::vector<std::string> heard(std::int64_t duration_ns) {
    std::vector<std::string> payloads;
    sick::TelegramReader reader(1000);
    for (const std::int64_t end_ns = now_ns_ + duration_ns; now_ns_ < end_ns; now_ns_ += kMs) {
      device_.tick(now_ns_);
      for (const SentBytes& sent : device_.take_output()) {
        std::span<const std::byte> rest = std::as_bytes(std::span(sent.bytes.data(), sent.bytes.size()));
        for (auto outcome = reader.take(rest); outcome != sick::TelegramReader::Outcome::kMore;
             outcome = reader.take(rest)) {
          if (outcome == sick::TelegramReader::Outcome::kTelegram) {
            const auto payload = reader.telegram().payload;
            payloads.emplace_back(reinterpret_cast<const char*>(payload.data()), payload.size());
          }
        }
      }
    }
    return payloads;
  }
  void say(const std::string& payload) {
    const sick::Request made(std::as_bytes(std::span(payload.data(), payload.size())));
    device_.receive({reinterpret_cast<const char*>(made.bytes().data()), made.bytes().size()}, now_ns_);
  }
  std::string answer_to(const std::string& payload) {
    static_cast<void>(heard(kMs));
    say(payload);
    const std::vector<std::string> payloads = heard(500 * kMs);
    return payloads.empty() ? "" : payloads.front();
  }
  void go_to_500000_baud() { ASSERT_THAT(answer_to(bytes({0x20, 0x48})), StartsWith(bytes({0xA0, 0}))); }
  /// What the world has, in the units of a telegram.
  std::vector<double> true_m(std::int64_t index = 0) {
    const std::vector<EmulatedBeam> beams = sick_beams(model_.variant);
    std::vector<double> ranges_m(beams.size());
    source_.measure(index, beams, ranges_m);
    return ranges_m;
  }
  static WorldDrive still() {
    WorldDrive drive;
    drive.world = parse_world("room 0 0  8 4\nbox 6 3  1 0.6\nspeed 0.01\ngo 1 2  1.01 2\n", "still");
    drive.noise_sd_m = 0.02;
    return drive;
  }

  std::int64_t now_ns_ = 1000 * kSecond;
  SickModel model_;
  WorldSource source_{sick::kTurnNs, still()};
  SickDevice device_{model_, source_, {}};
};

class EmulatedSickQuarter : public EmulatedSick {
 protected:
  EmulatedSickQuarter() : EmulatedSick("lms291-quarter") {}
};

TEST_F(EmulatedSick, SaysThatItIsOnAfterAReset) {
  go_to_500000_baud();
  say(bytes({0x10}));
  const std::vector<std::string> payloads = heard(3 * kSecond);
  ASSERT_EQ(payloads.size(), 2U);
  EXPECT_THAT(payloads[0], StartsWith(bytes({0x91})));
  EXPECT_THAT(payloads[1], StartsWith(bytes({0x90}) + "LMS291"));
  device_.set_line_baud(9600);
  EXPECT_THAT(answer_to(bytes({0x31})), StartsWith(bytes({0xB1}))) << "at the rate of power-up";
}

TEST_F(EmulatedSick, IsDeafUntilItIsOn) {
  say(bytes({0x10}));
  ASSERT_EQ(heard(500 * kMs).size(), 1U);
  EXPECT_THAT(answer_to(bytes({0x31})), IsEmpty());
  EXPECT_THAT(heard(kSecond), ::testing::ElementsAre(StartsWith(bytes({0x90}))));
}

TEST_F(EmulatedSick, ItsStateTellsMeasuringModeAndOperatingMode) {
  EXPECT_EQ(answer_to(bytes({0x31})).at(102), 0);
  ASSERT_THAT(answer_to(bytes({0x20, 0x00}) + "SICK_LMS"), StartsWith(bytes({0xA0, 0})));
  EXPECT_EQ(answer_to(bytes({0x31})).at(8), 0x00) << "installation";
  std::string configuration = answer_to(bytes({0x74})).substr(1, 34);
  configuration[5] = 6;
  configuration[6] = 1;
  ASSERT_THAT(answer_to(bytes({0x77}) + configuration), StartsWith(bytes({0xF7, 1})));
  const std::string state = answer_to(bytes({0x31}));
  EXPECT_EQ(state.at(102), 6);
  EXPECT_EQ(state.at(122), 1);
  ASSERT_THAT(answer_to(bytes({0x20, 0x25})), StartsWith(bytes({0xA0, 0})));
  EXPECT_EQ(answer_to(bytes({0x31})).at(8), 0x25);
}

TEST_F(EmulatedSick, StreamsMeanValues) {
  go_to_500000_baud();
  ASSERT_THAT(answer_to(bytes({0x20, 0x26, 10})), StartsWith(bytes({0xA0, 0})));
  const std::vector<std::string> payloads = heard(3 * kSecond);
  EXPECT_NEAR(static_cast<double>(payloads.size()), 3.0 / (20.0 * 0.013333), 2.0) << "one in ten scans";
  const std::vector<double> expected_m = true_m();
  double error_m = 0.0;
  for (const std::string& payload : payloads) {
    ASSERT_EQ(payload.substr(0, 2), bytes({0xB6, 10}));
    ASSERT_EQ(number(payload, 2), 361U);
    ASSERT_EQ(payload.size(), 4U + 2 * 361 + 1);
    for (std::size_t i = 0; i < expected_m.size(); ++i) {
      error_m = std::max(error_m, std::abs(number(payload, 4 + 2 * i) * 0.01 - expected_m[i]));
    }
  }
  EXPECT_LT(error_m, 0.12) << "both have noise of 2 cm";
}

TEST_F(EmulatedSick, StreamsAPartOfItsScans) {
  go_to_500000_baud();
  ASSERT_THAT(answer_to(bytes({0x20, 0x27, 21, 0, 120, 0})), StartsWith(bytes({0xA0, 0})));
  const std::vector<std::string> payloads = heard(kSecond);
  EXPECT_NEAR(static_cast<double>(payloads.size()), 37.5, 1.0);
  ASSERT_FALSE(payloads.empty());
  const std::string& payload = payloads.back();
  EXPECT_EQ(payload.substr(0, 7), bytes({0xB7, 21, 0, 120, 0, 100, 0}));
  ASSERT_EQ(payload.size(), 7U + 200 + 1);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_NEAR(number(payload, 7 + 2 * i) * 0.01, true_m()[20 + i], 0.15);
  }
}

TEST_F(EmulatedSick, StreamsMeansOfAPart) {
  go_to_500000_baud();
  ASSERT_THAT(answer_to(bytes({0x20, 0x28, 4, 1, 0, 50, 0})), StartsWith(bytes({0xA0, 0})));
  const std::vector<std::string> payloads = heard(kSecond);
  ASSERT_FALSE(payloads.empty());
  EXPECT_EQ(payloads.back().substr(0, 8), bytes({0xBF, 4, 1, 0, 50, 0, 50, 0}));
  EXPECT_EQ(payloads.back().size(), 8U + 100 + 1);
}

TEST_F(EmulatedSickQuarter, StreamsEachTurnByItself) {
  go_to_500000_baud();
  ASSERT_THAT(answer_to(bytes({0x20, 0x2A})), StartsWith(bytes({0xA0, 0})));
  const std::vector<std::string> payloads = heard(kSecond);
  EXPECT_NEAR(static_cast<double>(payloads.size()), 75.0, 2.0) << "every turn";
  for (std::size_t i = 0; i < payloads.size(); ++i) {
    const unsigned head = number(payloads[i], 1);
    const unsigned part = head >> 11U & 3U;
    EXPECT_NE(head & 0x2000U, 0U) << "a part";
    EXPECT_EQ(head & 0x3FFU, part == 0 ? 101U : 100U);
    EXPECT_EQ(payloads[i].size(), 3U + 2 * (head & 0x3FFU) + 1);
    if (i > 0) {
      EXPECT_EQ(part, ((number(payloads[i - 1], 1) >> 11U & 3U) + 1) % 4);
    }
    for (std::size_t k = 0; k < (head & 0x3FFU); ++k) {
      ASSERT_NEAR(number(payloads[i], 3 + 2 * k) * 0.01, true_m()[4 * k + part], 0.2) << part << " " << k;
    }
  }
}

TEST_F(EmulatedSick, GivesOneTelegramWhenItIsAsked) {
  EXPECT_EQ(answer_to(bytes({0x30, 0x01})).substr(0, 1), "") << "361 values take 0.76 s at 9600 baud";
  const std::vector<std::string> late = heard(kSecond);
  ASSERT_EQ(late.size(), 1U);
  EXPECT_EQ(late[0].substr(0, 3), bytes({0xB0, 0x69, 0x01}));
  go_to_500000_baud();
  EXPECT_THAT(answer_to(bytes({0x30, 0x01})), StartsWith(bytes({0xB0, 0x69, 0x01})));
  EXPECT_THAT(answer_to(bytes({0x36, 5})), StartsWith(bytes({0xB6, 5, 0x69, 0x01})));
  EXPECT_THAT(answer_to(bytes({0x37, 1, 0, 9, 0})), StartsWith(bytes({0xB7, 1, 0, 9, 0, 9, 0})));
  EXPECT_THAT(answer_to(bytes({0x3F, 3, 1, 0, 9, 0})), StartsWith(bytes({0xBF, 3, 1, 0, 9, 0, 9, 0})));
  EXPECT_THAT(heard(kSecond), IsEmpty());
}

TEST_F(EmulatedSick, RefusesWhatCannotBeAndGoesOn) {
  for (const std::string& wrong :
       {bytes({0x20, 0x26}), bytes({0x20, 0x26, 1}), bytes({0x20, 0x26, 251}), bytes({0x20, 0x27, 0, 0, 9, 0}),
        bytes({0x20, 0x27, 9, 0, 8, 0}), bytes({0x20, 0x27, 1, 0, 0x6A, 1}), bytes({0x20, 0x27, 1}),
        bytes({0x20, 0x77}), bytes({0x20})}) {
    EXPECT_THAT(answer_to(wrong), StartsWith(bytes({0xA0, 2})));
  }
  EXPECT_THAT(answer_to(bytes({0x36, 1})), StartsWith(bytes({0x92})));
  EXPECT_THAT(answer_to(bytes({0x55})), StartsWith(bytes({0x92})));
  EXPECT_THAT(answer_to(bytes({0x31})), StartsWith(bytes({0xB1})));
}

}  // namespace
}  // namespace odoless
