#include "drivers/lrf/sopas/telegram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>
#include <vector>

#include "core/base/rng.hpp"
#include "drivers/lrf/sopas/scan_data.hpp"
#include "drivers/lrf/sopas/scan_stream.hpp"

namespace odoless::sopas {
namespace {

using Outcome = TelegramReader::Outcome;

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<Outcome> outcomes_of(const std::string& bytes) {
  TelegramReader reader(4096);
  auto rest = std::as_bytes(std::span(bytes.data(), bytes.size()));
  std::vector<Outcome> outcomes;
  for (Outcome outcome = reader.take(rest); outcome != Outcome::kMore; outcome = reader.take(rest)) {
    outcomes.push_back(outcome);
  }
  return outcomes;
}

/// "sEN LMDscandata 1", as the operating instructions of the LMS4000 have it.
const std::string kStartAscii = "\x02sEN LMDscandata 1\x03";
const std::string kStartBinary("\x02\x02\x02\x02\x00\x00\x00\x11sEN LMDscandata \x01\x33", 26);

TEST(SopasRequest, IsTheManualsByteForByte) {
  EXPECT_EQ(text_of(Request(Dialect::kAscii, "sEN LMDscandata").number(1, 1).finish()), kStartAscii);
  EXPECT_EQ(text_of(Request(Dialect::kBinary, "sEN LMDscandata").number(1, 1).finish()), kStartBinary);
}

TEST(SopasRequest, LogsInAsTheManualSays) {
  EXPECT_EQ(text_of(Request(Dialect::kAscii, "sMN SetAccessMode").number(3, 1, 2).number(0xF4724744, 4).finish()),
            "\x02sMN SetAccessMode 03 F4724744\x03");
  EXPECT_EQ(text_of(Request(Dialect::kBinary, "sMN SetAccessMode").number(3, 1, 2).number(0xF4724744, 4).finish()),
            std::string("\x02\x02\x02\x02\x00\x00\x00\x17sMN SetAccessMode \x03\xF4\x72\x47\x44\xB3", 32));
}

TEST(SopasReader, FindsTelegramsOfBothDialectsAmongGarbage) {
  EXPECT_EQ(
      outcomes_of("xx" + kStartAscii + kStartBinary + "\x02yy" + kStartAscii),
      (std::vector{Outcome::kSkipped, Outcome::kTelegram, Outcome::kTelegram, Outcome::kSkipped, Outcome::kTelegram}));
}

TEST(SopasReader, AWrongSumOrLengthCostsNoOtherTelegram) {
  std::string damaged = kStartBinary;
  damaged[12] ^= 1;
  EXPECT_EQ(outcomes_of(damaged + kStartBinary), (std::vector{Outcome::kWrongSum, Outcome::kTelegram}));
  damaged = kStartBinary;
  damaged[7] = 0x20;  // longer than it is
  EXPECT_EQ(outcomes_of(damaged + kStartBinary), (std::vector{Outcome::kWrongSum, Outcome::kTelegram}));
  EXPECT_EQ(outcomes_of(kStartAscii.substr(0, 9) + kStartAscii), (std::vector{Outcome::kSkipped, Outcome::kTelegram}));
}

TEST(SopasReader, ATelegramOfTheGreatestLengthIsTakenAndNoLongerOne) {
  constexpr std::size_t kMost = 4096;
  for (const bool is_longer : {false, true}) {
    const std::string text(kMost - std::string("sSN ").size() + (is_longer ? 1 : 0), '1');
    const auto expected = std::vector{is_longer ? Outcome::kSkipped : Outcome::kTelegram, Outcome::kTelegram};
    EXPECT_EQ(outcomes_of("\x02sSN " + text + "\x03" + kStartAscii), expected);
  }
}

TEST(SopasTelegram, ARefusalTellsItsCodeInEveryForm) {
  EXPECT_EQ((Telegram{Dialect::kAscii, "sFA 3"}.refusal_code()), 3);
  EXPECT_EQ((Telegram{Dialect::kAscii, "sFA 1A"}.refusal_code()), 26);
  EXPECT_EQ((Telegram{Dialect::kBinary, std::string_view("sFA \x00\x03", 6)}.refusal_code()), 3);
  EXPECT_EQ((Telegram{Dialect::kBinary, std::string_view("sFA\x00\x03", 5)}.refusal_code()), 3);
  EXPECT_EQ((Telegram{Dialect::kAscii, "sFA"}.refusal_code()), -1);
}

TEST(SopasFields, TakeNumbersInHexadecimalOrWithASign) {
  Fields fields(Dialect::kAscii, "FFF92230 -450000 +2500 3DCCCCCD DIST1");
  EXPECT_EQ(fields.signed_number(), -450'000);
  EXPECT_EQ(fields.signed_number(), -450'000);
  EXPECT_EQ(fields.number(2), 2500U);
  EXPECT_FLOAT_EQ(fields.real(), 0.1F);
  EXPECT_EQ(fields.text(5), "DIST1");
  EXPECT_TRUE(fields.ok() && fields.empty());
}

/// The plain way: the standard library reads the digits.
std::optional<std::uint32_t> plain_number(std::string_view word, int bytes) {
  const bool is_decimal = word.starts_with('+') || word.starts_with('-');
  const std::string digits(is_decimal ? word.substr(1) : word);
  const bool is_number = !digits.empty() && digits.size() < 16 &&
                         std::all_of(digits.begin(), digits.end(),
                                     [&](unsigned char c) { return is_decimal ? std::isdigit(c) : std::isxdigit(c); });
  if (!is_number) {
    return std::nullopt;
  }
  const auto size = std::stoll(digits, nullptr, is_decimal ? 10 : 16);
  const auto value = word.starts_with('-') ? -size : size;
  const auto limit = 1LL << (8 * bytes);
  const bool is_in_range = value < limit && value >= (is_decimal ? -limit / 2 : 0);
  return is_in_range ? std::optional(static_cast<std::uint32_t>(value & (limit - 1))) : std::nullopt;
}

TEST(SopasFields, ANumberInTextIsReadAsTheStandardLibraryReadsIt) {
  Rng rng(5);
  constexpr std::string_view kCharacters = "+-0129aAfFgG :/@`";
  for (int i = 0; i < 100'000; ++i) {
    std::string word(rng.below(7), ' ');
    std::generate(word.begin(), word.end(), [&] { return kCharacters[rng.below(17)]; });
    const int bytes = 1 << rng.below(3);
    Fields fields(Dialect::kAscii, word);
    const std::uint32_t number = fields.number(bytes);
    const std::optional<std::uint32_t> plain = plain_number(word.substr(0, word.find(' ')), bytes);
    ASSERT_EQ(fields.ok(), plain.has_value()) << "'" << word << "' of " << bytes;
    ASSERT_EQ(number, plain.value_or(0)) << "'" << word << "' of " << bytes;
  }
}

TEST(SopasFields, RefuseWhatCannotBe) {
  for (const char* const wrong : {"", "10000", "G", "1-", "+-1", "-32769", " 1"}) {
    Fields fields(Dialect::kAscii, wrong);
    static_cast<void>(fields.number(2));
    EXPECT_FALSE(fields.ok()) << '"' << wrong << '"';
  }
}

// The head is of the form that a TiM551 sends; five beams from its right to behind its left.
const std::string kHead = "sSN LMDscandata 1 1 F510AB 0 0 5932 5933 5B87697D 5B877A0C 0 0 1 0 0 5DC 36 ";

std::string scan_text(const std::string& rest) { return kHead + rest; }

Result<ScanData> read(const std::string& content, std::span<std::uint16_t> ranges) {
  return scan_data_of({Dialect::kAscii, content}, ranges);
}

TEST(SopasScanData, SaysAllThatTheTelegramDoes) {
  std::vector<std::uint16_t> ranges(8);
  const auto data = read(scan_text("1 12 FFFF 2 DIST1 40000000 00000000 FFF92230 2710 5 3E8 7D0 0 1 FFFF "
                                   "DIST2 3F800000 00000000 FFF92230 2710 2 1 2 "
                                   "1 RSSI1 3F800000 00000000 FFF92230 2710 5 64 65 0 0 FF 0 0 0 0 0"),
                         ranges);
  ASSERT_TRUE(data.ok());
  const ScanData& scan = data.value();
  EXPECT_EQ(scan.serial_number, 0xF510ABU);
  EXPECT_EQ(scan.telegram_counter, 0x5932);
  EXPECT_EQ(scan.scan_counter, 0x5933);
  EXPECT_EQ(scan.sending_us - scan.stamp_us, 0x108FU);
  EXPECT_DOUBLE_EQ(scan.scans_hz, 15.0);
  EXPECT_DOUBLE_EQ(scan.measurements_khz, 5.4);
  EXPECT_EQ(scan.encoders, 1);
  EXPECT_EQ(scan.channels, 3);
  EXPECT_TRUE(scan.has_second_echo && scan.has_remission);
  EXPECT_EQ(scan.shape, (ScanShape{5, -450'000, 10'000, 2.0F, 0.0F, 5}));
  EXPECT_EQ(std::vector<std::uint16_t>(ranges.begin(), ranges.begin() + 5),
            (std::vector<std::uint16_t>{1000, 2000, 0, 1, 0xFFFF}));
}

TEST(SopasScanData, SaysWhatItDoesNotHave) {
  std::vector<std::uint16_t> ranges(8);
  const auto data = read(scan_text("0 1 DIST1 3F800000 00000000 FFF92230 2710 2 1 2 0 0 0 0 0 0"), ranges);
  ASSERT_TRUE(data.ok());
  EXPECT_EQ(data.value().channels, 1);
  EXPECT_FALSE(data.value().has_second_echo || data.value().has_remission);
}

TEST(SopasScanData, TellsATailThatIsNotAsDocumented) {
  std::vector<std::uint16_t> ranges(4);
  const auto has_whole_tail = [&](const std::string& tail) {
    return read(scan_text("0 1 DIST1 3F800000 00000000 FFF92230 2710 2 1 2 0" + tail), ranges)
        .value()
        .shape.has_whole_tail;
  };
  for (const char* const whole :
       {"", " 0", " 0 0 0 0 0", " 1 0 0 0 0 0 0 1 2 0 0 0 0", " 0 1 3 Tim 0 1 7D0 1 2 3 4 5 FFFFF 1 FDEC 1 2 3"}) {
    EXPECT_TRUE(has_whole_tail(whole)) << whole;
  }
  for (const char* const damaged :
       {" 2", " 0 0 0 0 33", " 0 0 0 0 202", " 0 0 0 0 0 0", " 0 0 0 1 7D0 1", " 0 1 9 Tim"}) {
    EXPECT_FALSE(has_whole_tail(damaged)) << damaged;
  }
}

TEST(SopasScanData, RefusesWhatIsNotWhole) {
  std::vector<std::uint16_t> ranges(4);
  const std::string channel = "0 1 DIST1 3F800000 00000000 FFF92230 2710 ";
  EXPECT_EQ(read(scan_text(channel + "5 1 2 3 4 5 0 0 0 0 0 0"), ranges).error(), Errc::kTooManyBeams);
  EXPECT_EQ(read(scan_text(channel + "3 1 2"), ranges).error(), Errc::kFrameMalformed);
  EXPECT_EQ(read(scan_text(channel + "2 1 10000 0 0 0 0 0 0"), ranges).error(), Errc::kFrameMalformed);
  EXPECT_EQ(read(scan_text("0 0 0 0 0 0 0 0"), ranges).error(), Errc::kWrongCount);
  EXPECT_EQ(read(kHead, ranges).error(), Errc::kFrameMalformed);
}

// SICK's angles count from the right of the device, 90 deg is its front; ours from the front.
TEST(SopasAngles, NinetyDegreesAreTheFront) {
  EXPECT_DOUBLE_EQ(bearing_rad(90.0), 0.0);
  EXPECT_NEAR(bearing_rad(0.0), -1.5707963267948966, 1e-12);   // right
  EXPECT_NEAR(bearing_rad(180.0), 1.5707963267948966, 1e-12);  // left
  EXPECT_NEAR(bearing_rad(-45.0), -2.356194490192345, 1e-12);  // first beam of a TiM5xx or LMS1xx
}

TEST(SopasAngles, AStepThatIsAFractionOfADegreeIsMeantWhole) {
  EXPECT_DOUBLE_EQ(step_deg(3333), 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(step_deg(833), 1.0 / 12.0);
  EXPECT_DOUBLE_EQ(step_deg(1667), 1.0 / 6.0);
  EXPECT_DOUBLE_EQ(step_deg(2500), 0.25);
  EXPECT_DOUBLE_EQ(step_deg(10000), 1.0);
  EXPECT_DOUBLE_EQ(step_deg(7000), 0.7);
}

// An LMS4000 counts tenths of a millimetre; below 16, counts are codes: too dark, too near, too far, dazzled.
TEST(SopasScanStream, ReadsRangesByTheirScale) {
  ScanStream stream(LrfParams{}, 16);
  const std::string content = scan_text("0 1 DIST1 3DCCCCCD 00000000 86470 341 5 2710 F 0 7530 10 0 0 0 0 0 0");
  const Result<ScanData> data = stream.read({Dialect::kAscii, content});
  ASSERT_TRUE(data.ok());
  ASSERT_EQ(stream.configure(data.value()), Errc::kOk);
  const Result<LrfScan> scan = stream.scan(data.value(), 5'000'000'000);
  ASSERT_TRUE(scan.ok());
  EXPECT_NEAR(static_cast<double>(scan.value().ranges_m[0]), 1.0, 1e-6);
  EXPECT_EQ(scan.value().ranges_m[1], 0.0F);
  EXPECT_EQ(scan.value().ranges_m[2], 0.0F);
  EXPECT_NEAR(static_cast<double>(scan.value().ranges_m[3]), 3.0, 1e-6);
  EXPECT_NEAR(static_cast<double>(scan.value().ranges_m[4]), 0.0016, 1e-6);
  EXPECT_NEAR(scan.value().start_angle_rad, bearing_rad(55.0), 1e-6);
}

}  // namespace
}  // namespace odoless::sopas
