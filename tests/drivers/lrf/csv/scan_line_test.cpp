#include "drivers/lrf/csv/scan_line.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/tools/emulate_support.hpp"

namespace odoless::csv {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(CsvScanLine, IsRead) {
  std::vector<float> ranges_m(8);
  const auto line = scan_line_of("scan,12.5,-1.5,0.5,0.0001,1.25,inf,,nan,-1,0,2", ranges_m);
  ASSERT_TRUE(line.ok());
  EXPECT_DOUBLE_EQ(line.value().stamp_s.value(), 12.5);
  EXPECT_EQ(line.value().shape, (ScanShape{7, -1.5, 0.5, 0.0001}));
  EXPECT_EQ(std::vector<float>(ranges_m.begin(), ranges_m.begin() + 7),
            (std::vector<float>{1.25F, kInfinity, 0.0F, 0.0F, 0.0F, 0.0F, 2.0F}));
}

TEST(CsvScanLine, NeedsNoTimes) {
  std::vector<float> ranges_m(8);
  const auto line = scan_line_of("scan,,-1.5,0.5,,1,2\r", ranges_m);
  ASSERT_TRUE(line.ok());
  EXPECT_FALSE(line.value().stamp_s.has_value());
  EXPECT_EQ(line.value().shape.beam_period_s, 0.0);
  EXPECT_EQ(line.value().shape.beams, 2);
}

TEST(CsvScanLine, IsRefusedWhereItCannotBe) {
  std::vector<float> ranges_m(3);
  for (const char* const malformed :
       {"", "scan", "scan,", "Scan,1,0,0.1,,1,2", "scan,x,0,0.1,,1,2", "scan,1,0,0.1,,1,x", "scan,1,,0.1,,1,2",
        "scan,1,0,0.1,0.1s,1,2", "scan,1,0,0.1,,1,1.2.3", "scan,1,0,0.1,,1,-inf", "scan,1,0,0.1,,1,20000",
        "scan,1,0,0.1,,1 2"}) {
    const auto line = scan_line_of(malformed, ranges_m);
    ASSERT_FALSE(line.ok()) << malformed;
    EXPECT_EQ(line.error(), Errc::kFrameMalformed) << malformed;
  }
  for (const char* const impossible :
       {"scan,1,nan,0.1,,1,2", "scan,1,7,0.1,,1,2", "scan,1,0,0,,1,2", "scan,1,0,inf,,1,2", "scan,1,0,nan,,1,2",
        "scan,1,0,0.1,-1,1,2", "scan,1,0,0.1,2,1,2", "scan,-1,0,0.1,,1,2", "scan,nan,0,0.1,,1,2",
        "scan,1e12,0,0.1,,1,2", "scan,1,0,0.1,,1"}) {
    const auto line = scan_line_of(impossible, ranges_m);
    ASSERT_FALSE(line.ok()) << impossible;
    EXPECT_EQ(line.error(), Errc::kBadGeometry) << impossible;
  }
  EXPECT_EQ(scan_line_of("scan,1,0,0.1,,1,2,3,4", ranges_m).error(), Errc::kTooManyBeams);
}

TEST(CsvLineReader, ThrowsAwayWhatIsTooLongAndGoesOn) {
  LineReader reader(8);
  const std::string bytes = "1234\n123456789012345678\nabc\n";
  auto rest = std::as_bytes(std::span(bytes.data(), bytes.size()));
  EXPECT_EQ(reader.take(rest), LineReader::Outcome::kLine);
  EXPECT_EQ(reader.line(), "1234");
  EXPECT_EQ(reader.take(rest), LineReader::Outcome::kSkipped);
  EXPECT_EQ(reader.take(rest), LineReader::Outcome::kLine);
  EXPECT_EQ(reader.line(), "abc");
  EXPECT_EQ(reader.take(rest), LineReader::Outcome::kMore);
}

TEST(CsvSession, ItsPeriodIsThatOfTwoLinesInARow) {
  LrfParams params;
  params.driver = LrfDriver::kCsv;
  const auto session = make_lrf_session(params, 8);
  test::Heard heard;
  session->reset(0);
  std::int64_t now_ns = 0;
  for (const auto& [line, is_ready] : {std::pair("scan,,-1.5,0.5,,1,2\n", false),
                                       {"scan,,nonsense\n", false},
                                       {"scan,,-1.5,0.5,,1,2\n", false},
                                       {"scan,,-1.5,0.5,,1,2\n", true}}) {
    now_ns += 100 * test::kMs;
    session->receive(std::as_bytes(std::span(std::string_view(line))), now_ns, heard);
    EXPECT_EQ(session->ready(), is_ready) << "at " << now_ns;
  }
  EXPECT_EQ(session->geometry().period_ns, 100 * test::kMs);
}

TEST(CsvSession, StampsAreThoseOfTheFirstBeams) {
  LrfParams params;
  params.driver = LrfDriver::kCsv;
  test::Bench bench("csv", {}, params);
  bench.reset();
  bench.run(10 * test::kSecond);
  const auto& heard = bench.heard().scans;
  ASSERT_GT(heard.size(), 190U);
  for (std::size_t i = heard.size() / 3; i < heard.size(); ++i) {
    const SentScan& scan = bench.sent()[bench.sent().size() - heard.size() + i];
    EXPECT_LT(std::abs(heard[i].stamp_ns - scan.first_beam_ns), test::kMs) << i;
  }
}

}  // namespace
}  // namespace odoless::csv
