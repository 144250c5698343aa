#include "drivers/lrf/sick/scan_stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/times.hpp"

namespace odoless {
namespace {

using test::kMs;
using test::kSecond;

constexpr std::size_t kRangesAt = 3;  ///< of a scan's payload: behind the command and the number of beams

/// A scan of 181 beams of 2 m.
std::vector<std::byte> sick_scan(SickUnit unit) {
  std::vector<std::byte> payload(kRangesAt + 2 * 181 + 1);
  payload[0] = std::byte{0xB0};
  payload[1] = std::byte{181};
  payload[2] = unit == SickUnit::kMm ? std::byte{0x40} : std::byte{0x00};
  for (std::size_t i = kRangesAt; i + 1 < payload.size(); i += 2) {
    const unsigned value = unit == SickUnit::kMm ? 2000 : 200;
    payload[i] = static_cast<std::byte>(value & 0xFFU);
    payload[i + 1] = static_cast<std::byte>(value >> 8U);
  }
  return payload;
}

sick::ScanStream sick_stream(SickUnit unit) {
  LrfParams params;
  params.sick_unit = unit;
  params.sick_variant = SickVariant::k180By1;
  sick::ScanStream stream(params, 500);
  EXPECT_EQ(stream.configure(500000), Errc::kOk);
  return stream;
}

/// As the first beam of a scan.
float heard_sick_m(SickUnit unit, unsigned value) {
  std::vector<std::byte> payload = sick_scan(unit);
  payload[kRangesAt] = static_cast<std::byte>(value & 0xFFU);
  payload[kRangesAt + 1] = static_cast<std::byte>(value >> 8U);
  sick::ScanStream stream = sick_stream(unit);
  const Result<LrfScan> scan = stream.scan({payload}, kSecond);
  EXPECT_TRUE(scan.ok());
  EXPECT_FLOAT_EQ(scan.value().ranges_m[1], 2.0F);
  EXPECT_FLOAT_EQ(scan.value().ranges_m[180], 2.0F);
  return scan.value().ranges_m[0];
}

TEST(SickScanStream, TellsWhatIsTooFarFromWhatCannotBeSaid) {
  for (const auto& [unit, mask, unit_m] :
       {std::tuple(SickUnit::kMm, 0x7FFFU, 0.001F), {SickUnit::kCm, 0x1FFFU, 0.01F}}) {
    EXPECT_FLOAT_EQ(heard_sick_m(unit, mask - 9), static_cast<float>(mask - 9) * unit_m) << "the farthest";
    EXPECT_TRUE(std::isinf(heard_sick_m(unit, mask - 8))) << "nothing answers";
    for (unsigned code = mask - 7; code <= mask; ++code) {
      EXPECT_EQ(heard_sick_m(unit, code), 0.0F) << "dazzled, too little signal, a fault";
    }
    EXPECT_FLOAT_EQ(heard_sick_m(unit, (mask + 1) | 123U), 123.0F * unit_m) << "a higher bit tells of a field";
  }
}

TEST(SickScanStream, RefusesScansOfAnotherUnitOrSizeAndPartsOfScans) {
  struct Case {
    std::size_t at;
    int value;
    Errc reason;
  };
  for (const SickUnit unit : {SickUnit::kMm, SickUnit::kCm}) {
    sick::ScanStream stream = sick_stream(unit);
    const int usual = unit == SickUnit::kMm ? 0x40 : 0;
    for (const Case& refused :
         {Case{2, 0x40 - usual, Errc::kFrameMalformed}, Case{2, usual | 0x80, Errc::kFrameMalformed},
          Case{2, usual | 0x20, Errc::kFrameMalformed}, Case{1, 180, Errc::kWrongCount},
          Case{1, 182, Errc::kWrongCount}, Case{2, usual | 0x01, Errc::kWrongCount}}) {
      std::vector<std::byte> payload = sick_scan(unit);
      payload[refused.at] = static_cast<std::byte>(refused.value);
      EXPECT_EQ(stream.scan({payload}, kSecond).error(), refused.reason) << refused.value;
    }
    std::vector<std::byte> shorter = sick_scan(unit);
    shorter.erase(shorter.begin() + 100, shorter.begin() + 102);
    EXPECT_EQ(stream.scan({shorter}, kSecond).error(), Errc::kWrongCount);
  }
}

}  // namespace
}  // namespace odoless
