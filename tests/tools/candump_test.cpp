#include "tools/log/candump.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/base/rng.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/command/error.hpp"

namespace odoless {
namespace {

// Lines as can-utils' candump -L writes them.
TEST(Candump, ReadsAndWritesTheLinesOfCanUtils) {
  for (const char* const line :
       {"(1436509052.249713) vcan0 044#2A366C2BBA", "(1436509053.850870) can0 601#2F60600001000000",
        "(1436509054.000001) can0 080#", "(1436509054.000001) can0 00000123#11223344",
        "(1436509054.000001) can0 20000040#0000000000000000", "(0000000001.500000) slcan1 7FF#R",
        "(0000000001.500000) can0 1F334455#R8"}) {
    const auto recorded = parse_candump_line(line);
    ASSERT_TRUE(recorded) << line;
    EXPECT_EQ(candump_line(*recorded), line);
  }
  const auto recorded = parse_candump_line("(1436509052.249713) vcan0 044#2A366C2BBA R");
  ASSERT_TRUE(recorded);
  EXPECT_EQ(recorded->stamp_us, 1436509052249713);
  EXPECT_EQ(recorded->interface, "vcan0");
  EXPECT_EQ(recorded->frame.id, 0x44U);
  EXPECT_EQ(recorded->frame.size_bytes, 5);
  EXPECT_EQ(recorded->frame.data[4], 0xBA);
  EXPECT_TRUE(parse_candump_line("(1.500000) can0 20000040#00")->frame.is_error());
}

TEST(Candump, RefusesWhatIsNoSuchLine) {
  for (const char* const line : {"",
                                 "(",
                                 "()",
                                 "(1.5) can0 123#",
                                 "(1.500000)can0 123#",
                                 "(1.500000) can0",
                                 "(1.500000) can0 123",
                                 "(1.500000) can0 12#",
                                 "(1.500000) can0 800#",
                                 "(1.500000) can0 123#1",
                                 "(1.500000) can0 123#0G",
                                 "(1.500000) can0 123#112233445566778899",
                                 "(-1.500000) can0 123#",
                                 "(1.500000) can0 123#R9",
                                 "(1.500000) can0 123##311223344",
                                 "(1.500000)  123#",
                                 "x(1.500000) can0 123#",
                                 "(99999999999999999.500000) can0 123#",
                                 "(1.500000) can0 FFFFFFFF#",
                                 "(1.500000) can0 123#R8x"}) {
    EXPECT_FALSE(parse_candump_line(line)) << line;
  }
  EXPECT_FALSE(parse_candump_line("(1.500000) can0 C0000001#")) << "flags are no part of an id";
}

TEST(Candump, AnyFrameGoesThereAndBack) {
  Rng rng(9);
  for (int i = 0; i < 5000; ++i) {
    RecordedCanFrame recorded;
    recorded.stamp_us = rng.next() * std::int64_t{1'000'003};
    recorded.interface = "can" + std::to_string(rng.below(10));
    constexpr std::uint32_t kFlags[] = {0, CanFrame::kExtendedFlag, CanFrame::kRemoteFlag, CanFrame::kErrorFlag};
    const std::uint32_t flag = kFlags[rng.below(4)];
    const bool is_long = flag == CanFrame::kExtendedFlag || flag == CanFrame::kErrorFlag;
    recorded.frame.id = flag | rng.below(is_long ? 0x20000000U : 0x800U);
    recorded.frame.size_bytes = static_cast<std::uint8_t>(rng.below(9));
    for (std::size_t k = 0; k < recorded.frame.size_bytes && flag != CanFrame::kRemoteFlag; ++k) {
      recorded.frame.data[k] = static_cast<std::uint8_t>(rng.below(256));
    }
    ASSERT_EQ(parse_candump_line(candump_line(recorded)), recorded) << candump_line(recorded);
  }
}

TEST(Candump, AChangedLineIsReadOrRefusedButNeverMisread) {
  Rng rng(10);
  const std::string line = "(1436509052.249713) vcan0 044#2A366C2BBA";
  for (int i = 0; i < 20'000; ++i) {
    std::string changed = line;
    changed[rng.below(static_cast<std::uint32_t>(line.size()))] = static_cast<char>(rng.below(256));
    if (const auto recorded = parse_candump_line(changed)) {
      ASSERT_LE(recorded->frame.size_bytes, 8);
      ASSERT_TRUE(parse_candump_line(candump_line(*recorded)) == recorded);
    }
  }
}

TEST(Candump, WritesFilesAndReadsThem) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "bus.log";
  const auto first = *parse_candump_line("(1436509052.249713) vcan0 044#2A366C2BBA");
  const auto second = *parse_candump_line("(1436509052.349713) vcan0 045#");
  {
    CandumpWriter writer(path);
    writer.write(first);
    writer.write(second);
  }
  EXPECT_THAT(read_candump(path), ::testing::ElementsAre(first, second));
  std::ofstream(path, std::ios::app) << "garbage\n";
  EXPECT_THROW(static_cast<void>(read_candump(path)), DataError);
  EXPECT_THROW(CandumpWriter(folder.path() / "none" / "bus.log"), CannotCreateError);
}

}  // namespace
}  // namespace odoless
