// A frame as candump writes it into a log, which canplayer and others read (can-utils, lib.h).
#include "drivers/io/candump_text.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace odoless {
namespace {

std::string text_of(const CanFrame& frame, std::int64_t stamp_us = 1'700'000'000'123'456,
                    std::string_view interface = "can0") {
  std::array<char, kCandumpTextMax> buffer{};
  return std::string(candump_text(stamp_us, interface, frame, buffer));
}

TEST(CandumpText, IsALineOfALog) {
  EXPECT_EQ(text_of({.id = 0x201, .size_bytes = 2, .data = {0x0F, 0xA0}}), "(1700000000.123456) can0 201#0FA0");
  EXPECT_EQ(text_of({.id = 0x080}), "(1700000000.123456) can0 080#");
  EXPECT_EQ(text_of({.id = 0x080}, 5'000'007), "(0000000005.000007) can0 080#");
  EXPECT_EQ(text_of({.id = 0x080}, -1), "(0000000000.000000) can0 080#") << "no stamp";
}

TEST(CandumpText, TellsTheKindOfAFrame) {
  EXPECT_EQ(text_of({.id = 0x123 | CanFrame::kExtendedFlag, .size_bytes = 1, .data = {7}}),
            "(1700000000.123456) can0 00000123#07");
  EXPECT_EQ(text_of({.id = 0x77F | CanFrame::kRemoteFlag}), "(1700000000.123456) can0 77F#R");
  EXPECT_EQ(text_of({.id = 0x77F | CanFrame::kRemoteFlag, .size_bytes = 4}), "(1700000000.123456) can0 77F#R4");
  EXPECT_EQ(text_of({.id = CanFrame::kErrorFlag | CanFrame::kErrorBusOff}), "(1700000000.123456) can0 20000040#");
}

TEST(CandumpText, TakesAnInterfaceAsLongAsTheKernelsNames) {
  EXPECT_EQ(text_of({.id = 0x080}, 0, "can0123456789abcdef"), "(0000000000.000000) can0123456789ab 080#");
}

}  // namespace
}  // namespace odoless
