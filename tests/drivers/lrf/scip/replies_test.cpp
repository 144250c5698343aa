#include "drivers/lrf/scip/replies.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "drivers/lrf/scip/number.hpp"

namespace odoless::scip {
namespace {

/// Cuts one reply out of `text`; what is wrong with it is for the functions under test to find.
class ReplyIn {
 public:
  explicit ReplyIn(std::string_view text) { EXPECT_EQ(reader_.take(text), ReplyReader::Outcome::kReply); }
  [[nodiscard]] Reply get() const { return reader_.reply(); }

 private:
  ReplyReader reader_{4096, 64};
};

std::string summed_line(const std::string& line) { return line + checksum(line) + "\n"; }

// As a URG-04LX sends it.
const std::string kParameters =
    "PP\n00P\nMODL:URG-04LX(Hokuyo Automatic Co.,Ltd.);N\nDMIN:20;" + std::string(1, checksum("DMIN:20")) +
    "\nDMAX:5600;_\nARES:1024;" + checksum("ARES:1024") + "\nAMIN:44;" + checksum("AMIN:44") + "\nAMAX:725;" +
    checksum("AMAX:725") + "\nAFRT:384;" + checksum("AFRT:384") + "\nSCAN:600;" + checksum("SCAN:600") + "\n\n";

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  return text.replace(text.find(what), what.size(), with);
}

TEST(ScipReplies, ReadsParameters) {
  const Result<Parameters> parameters = parameters_of(ReplyIn(kParameters).get());
  ASSERT_TRUE(parameters.ok()) << describe(parameters.error());
  EXPECT_EQ(parameters.value().range_min_mm, 20);
  EXPECT_EQ(parameters.value().range_max_mm, 5600);
  EXPECT_EQ(parameters.value().steps_per_turn, 1024);
  EXPECT_EQ(parameters.value().first_step, 44);
  EXPECT_EQ(parameters.value().last_step, 725);
  EXPECT_EQ(parameters.value().front_step, 384);
  EXPECT_EQ(parameters.value().turns_per_minute, 600);
  EXPECT_TRUE(parameters.value().is_urg);
}

TEST(ScipReplies, TakesASumThatHoldsTheSemicolonToo) {
  const std::string text = replaced(kParameters, "DMAX:5600;_", std::string("DMAX:5600;") + checksum("DMAX:5600;"));
  EXPECT_TRUE(parameters_of(ReplyIn(text).get()).ok());
}

TEST(ScipReplies, RefusesParametersThatCannotBe) {
  const auto error_with = [](const std::string& key, const std::string& line) {
    const std::size_t start = kParameters.find(key);
    std::string text = kParameters;
    text.replace(start, text.find('\n', start) - start, line + ";" + checksum(line));
    return parameters_of(ReplyIn(text).get()).error();
  };
  EXPECT_EQ(error_with("ARES", "ARES:1024"), Errc::kOk);
  for (const char* const line : {"ARES:0", "ARES:-1024", "ARES:600", "ARES:99999999", "AMAX:44", "AMAX:43", "AMIN:725",
                                 "DMAX:20", "DMAX:999999999", "SCAN:0", "AFRT:9999", "AMIN:-1"}) {
    EXPECT_EQ(error_with(std::string(line).substr(0, 4), line), Errc::kBadGeometry) << line;
  }
  for (const char* const line : {"ARES:", "ARES:x", "ARES:12x", "ARES:99999999999999", "ARES 1024"}) {
    EXPECT_EQ(error_with("ARES", line), Errc::kFrameMalformed) << line;
  }
  EXPECT_EQ(error_with("ARES", "OTHER:5"), Errc::kFrameMalformed);
  EXPECT_EQ(error_with("ARES", "ZRES:1024"), Errc::kFrameTruncated);
  EXPECT_EQ(parameters_of(ReplyIn(replaced(kParameters, "5600;_", "5601;_")).get()).error(), Errc::kWrongSum);
  EXPECT_EQ(parameters_of(ReplyIn("PP\n0Ee\n\n").get()).error(), Errc::kDeviceStatus);
  EXPECT_EQ(parameters_of(ReplyIn("PP\n\n").get()).error(), Errc::kFrameTruncated);
}

// Three beams of 1234, 5432 and 0 mm at 16,000,000 ms.
const std::string kScan = "MD0000000201000\n99b\n" + summed_line("m2@0") + summed_line("0CB1Dh000") + "\n";
constexpr ScanFormat kFormat{.echo = "MD0000000201000", .beams = 3};

/// What `text` is read as: the three ranges, or what is wrong with it.
struct Read {
  Errc error = Errc::kOk;
  std::uint32_t stamp_ms = 0;
  std::array<std::uint32_t, 3> ranges_mm{};
};

Read read(const std::string& text, const ScanFormat& format = kFormat) {
  Read read;
  std::array<char, 256> data{};
  const ReplyIn reply(text);
  const Result<RawFrame> frame = scan_of(reply.get(), format, {data, read.ranges_mm});
  read.error = frame.error();
  read.stamp_ms = frame.ok() ? frame.value().stamp_ms : 0;
  return read;
}

Errc scan_error(const std::string& text) { return read(text).error; }

TEST(ScipReplies, ReadsAScan) {
  const Read scan = read(kScan);
  ASSERT_EQ(scan.error, Errc::kOk);
  EXPECT_EQ(scan.stamp_ms, 16'000'000U);
  EXPECT_EQ(scan.ranges_mm, (std::array<std::uint32_t, 3>{1234, 5432, 0}));
}

TEST(ScipReplies, ReadsRangesOfTwoCharactersAndRangesWithIntensities) {
  constexpr std::string_view kEcho = "MD0000000201000";
  const std::string begin = std::string(kEcho) + "\n99b\n" + summed_line("m2@0");
  const Read shorter =
      read(begin + summed_line("CB0100") + "\n", {.echo = kEcho, .characters_per_value = 2, .beams = 3});
  EXPECT_EQ(shorter.error, Errc::kOk);
  EXPECT_EQ(shorter.ranges_mm, (std::array<std::uint32_t, 3>{1234, 1, 0}));
  const Read pairs =
      read(begin + summed_line("0CB1Dh1Dh0CB000001") + "\n", {.echo = kEcho, .values_per_beam = 2, .beams = 3});
  EXPECT_EQ(pairs.error, Errc::kOk);
  EXPECT_EQ(pairs.ranges_mm, (std::array<std::uint32_t, 3>{1234, 5432, 0}));
}

TEST(ScipReplies, NamesWhatIsWrongWithAScan) {
  EXPECT_EQ(scan_error(kScan), Errc::kOk);
  EXPECT_EQ(scan_error(replaced(kScan, "MD0000000201000", "MD0000000201001")), Errc::kWrongEcho);
  EXPECT_EQ(scan_error(replaced(kScan, "99b", "99c")), Errc::kWrongSum);
  EXPECT_EQ(scan_error(replaced(kScan, "99b", summed_line("0E").substr(0, 3))), Errc::kDeviceStatus);
  EXPECT_EQ(scan_error(replaced(kScan, "99b", "y9b")), Errc::kFrameMalformed) << "the sum doesn't see that bit";
  EXPECT_EQ(scan_error(replaced(kScan, "m2@0", "m2@1")), Errc::kWrongSum);
  EXPECT_EQ(scan_error(replaced(kScan, "m2@0", "m2@")), Errc::kFrameMalformed);
  EXPECT_EQ(scan_error(replaced(kScan, "0CB", "0CC")), Errc::kWrongSum);
  EXPECT_EQ(scan_error(replaced(kScan, "0CB", "0\x03\x42")), Errc::kFrameMalformed) << "nor that one";
  EXPECT_EQ(scan_error(replaced(kScan, summed_line("0CB1Dh000"), summed_line("0CB1Dh"))), Errc::kWrongCount);
  EXPECT_EQ(scan_error(replaced(kScan, summed_line("0CB1Dh000"), summed_line("0CB1Dh000000"))), Errc::kWrongCount);
  EXPECT_EQ(scan_error(replaced(kScan, summed_line("0CB1Dh000"), summed_line("0CB1Dh000") + summed_line("000"))),
            Errc::kWrongCount);
  EXPECT_EQ(scan_error(replaced(kScan, summed_line("m2@0") + summed_line("0CB1Dh000"), "")), Errc::kFrameTruncated);
}

// 0CB, 1Dh and 000 are 1234, 5432 and 0; intensities of 1, 2 and 3 are 001, 002 and 003.
constexpr std::string_view kEchoes = "ND0000000201000";

Read read_echoes(const std::string& data, EchoChoice choice) {
  std::string text = std::string(kEchoes) + "\n99b\n" + summed_line("m2@0");
  for (std::size_t at = 0; at < data.size(); at += 64) {
    text += summed_line(data.substr(at, 64));
  }
  return read(
      text + "\n",
      {.echo = kEchoes, .values_per_beam = choice == EchoChoice::kStrongest ? 2U : 1U, .beams = 3, .choice = choice});
}

TEST(ScipReplies, TakesTheFarthestOfSeveralEchoes) {
  using Ranges = std::array<std::uint32_t, 3>;
  EXPECT_EQ(read_echoes("0CB1Dh000", EchoChoice::kLast).ranges_mm, (Ranges{1234, 5432, 0}));
  EXPECT_EQ(read_echoes("0CB&1Dh1Dh000&0CB&1Dh", EchoChoice::kLast).ranges_mm, (Ranges{5432, 5432, 5432}));
  EXPECT_EQ(read_echoes("1Dh&0CB0000CB", EchoChoice::kLast).ranges_mm, (Ranges{5432, 0, 1234})) << "in any order";
}

TEST(ScipReplies, TakesTheStrongestOfSeveralEchoes) {
  using Ranges = std::array<std::uint32_t, 3>;
  const Read scan = read_echoes("0CB002&1Dh0011Dh001&0CB0020CB001&1Dh003&000002", EchoChoice::kStrongest);
  EXPECT_EQ(scan.error, Errc::kOk);
  EXPECT_EQ(scan.ranges_mm, (Ranges{1234, 1234, 5432}));
  const std::string most = "0CB001&1Dh003&000002";  // of three beams, it takes more than a line
  EXPECT_EQ(read_echoes(most + most + most, EchoChoice::kStrongest).ranges_mm, (Ranges{5432, 5432, 5432}));
}

TEST(ScipReplies, RefusesEchoesThatCannotBe) {
  for (const char* const data :
       {"&0CB1Dh000", "0CB1Dh000&", "0CB&1Dh000", "0CB1Dh&&000000", "0CB&0CB&0CB&0CB1Dh000", "0CB&1D&h000000",
        "0CB1Dh00", "0CB1Dh000000", "0CB1Dh000&0CB0", "0CB&0CB&0CB1Dh&1Dh&1Dh000&000&000&000"}) {
    EXPECT_EQ(read_echoes(data, EchoChoice::kLast).error, Errc::kWrongCount) << data;
  }
  EXPECT_EQ(read_echoes("0CB1Dh0&0", EchoChoice::kLast).error, Errc::kWrongCount) << "a separator within a number";
  EXPECT_EQ(read_echoes("0CB1Dh0%0", EchoChoice::kLast).error, Errc::kFrameMalformed);
  EXPECT_EQ(read_echoes("0CB1Dh0&0", EchoChoice::kOnly).error, Errc::kFrameMalformed) << "none was asked for";
}

TEST(ScipReplies, TellsScip1FromScip2) {
  EXPECT_TRUE(is_scip1(ReplyIn("QT\nE\n\n").get()));
  EXPECT_TRUE(is_scip1(ReplyIn("SCIP2.0\n0\n\n").get()));
  EXPECT_FALSE(is_scip1(ReplyIn("QT\n00P\n\n").get()));
}

TEST(ReplyReader, DropsWhatIsLongerThanItsMemory) {
  ReplyReader reader(16, 4);
  std::string_view bytes = "a line that is far too long for that\nand more\n\nab\ncd\n\n";
  EXPECT_EQ(reader.take(bytes), ReplyReader::Outcome::kCut);
  EXPECT_EQ(reader.take(bytes), ReplyReader::Outcome::kReply);
  EXPECT_EQ(reader.reply().lines(), 2);
  EXPECT_EQ(reader.reply().line(1), "cd");
  EXPECT_EQ(reader.reply().line(2), "");
  std::string_view lines = "1\n2\n3\n4\n5\n6\n\n1\n2\n3\n4\n\n";
  EXPECT_EQ(reader.take(lines), ReplyReader::Outcome::kCut);
  EXPECT_EQ(reader.take(lines), ReplyReader::Outcome::kReply);
  EXPECT_EQ(reader.reply().lines(), 4);
}

TEST(ReplyReader, AnEchoStartsAReplyAnew) {
  ReplyReader reader(64, 8);
  reader.expect_stream("MD");
  std::string_view bytes = "MD\n99b\nhalf a lin\x0bMD\n99b\n\n";
  EXPECT_EQ(reader.take(bytes), ReplyReader::Outcome::kCut);
  EXPECT_EQ(reader.take(bytes), ReplyReader::Outcome::kReply);
  EXPECT_EQ(reader.reply().lines(), 2);
  EXPECT_EQ(reader.reply().line(0), "MD");
}

}  // namespace
}  // namespace odoless::scip
