// What the emulated laser answers, by the protocol's description.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/emulate_support.hpp"
#include "tools/emulate/scip_device.hpp"
#include "tools/emulate/scip_text.hpp"

namespace odoless {
namespace {

using test::kMs;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class EmulatedScip : public ::testing::Test {
 protected:
  /// What it says to that.
  std::string said(const std::string& request) {
    device_.receive(request, now_ns_);
    return said_until(now_ns_);
  }
  std::string said_until(std::int64_t now_ns) {
    now_ns_ = now_ns;
    device_.tick(now_ns_);
    std::string all;
    for (const SentBytes& sent : device_.take_output()) {
      all += sent.bytes;
    }
    return all;
  }
  static std::string answer(const std::string& echo, const std::string& status) { return scip::answer(echo, status); }

  std::int64_t now_ns_ = test::kSecond;
  ScipModel model_ = *find_scip_model("utm-30lx");
  WorldSource source_{model_.turn_ns(), test::small_drive()};
  ScipDevice device_{model_, source_, {}, now_ns_};
};

TEST_F(EmulatedScip, KnowsEveryCommand) {
  EXPECT_THAT(said("VV\n"), StartsWith("VV\n00P\nVEND:Hokuyo Automatic Co.,Ltd.;"));
  EXPECT_THAT(said("PP\n"), StartsWith("PP\n00P\nMODL:UTM-30LX(Hokuyo Automatic Co.,Ltd.);"));
  EXPECT_THAT(said("II\n"), HasSubstr("LASR:OFF;"));
  EXPECT_EQ(said("BM\n"), answer("BM", "00"));
  EXPECT_EQ(said("BM\n"), answer("BM", "02"));
  EXPECT_THAT(said("II\n"), HasSubstr("LASR:ON;"));
  EXPECT_EQ(said("QT\n"), answer("QT", "00"));
  EXPECT_EQ(said("RS\n"), answer("RS", "00"));
  EXPECT_EQ(said("SS115200\n"), answer("SS115200", "00"));
  EXPECT_EQ(said("SS115200\n"), answer("SS115200", "03"));
  EXPECT_EQ(said("SS000001\n"), answer("SS000001", "02"));
  EXPECT_EQ(said("SSfast\n"), answer("SSfast", "01"));
  EXPECT_EQ(said("CR05\n"), answer("CR05", "00"));
  EXPECT_EQ(said("CR77\n"), answer("CR77", "02"));
  EXPECT_EQ(said("HS1\n"), answer("HS1", "00"));
  EXPECT_EQ(said("XX\n"), answer("XX", "0E"));
  EXPECT_EQ(said("QT;tag\r\n"), answer("QT;tag", "00"));
  EXPECT_EQ(said("\n\r\n"), "");
}

TEST_F(EmulatedScip, KeepsTimeModeApart) {
  EXPECT_EQ(said("TM1\n"), answer("TM1", "04"));
  EXPECT_EQ(said("TM2\n"), answer("TM2", "03"));
  EXPECT_EQ(said("TM0\n"), answer("TM0", "00"));
  EXPECT_EQ(said("TM0\n"), answer("TM0", "02"));
  EXPECT_EQ(said("QT\n"), answer("QT", "0E"));
  now_ns_ += 1234 * kMs;
  EXPECT_EQ(said("TM1\n"), "TM1\n00P\n" + scip::summed("00CB") + "\n");
  EXPECT_EQ(said("TM2\n"), answer("TM2", "00"));
  EXPECT_EQ(said("TM9\n"), answer("TM9", "01"));
}

TEST_F(EmulatedScip, RefusesWrongScanRequests) {
  EXPECT_EQ(said("GD0000108001\n"), answer("GD0000108001", "10")) << "the laser is off";
  for (const auto& [request, status] : std::vector<std::pair<std::string, std::string>>{{"MDx000108001000", "01"},
                                                                                        {"MD0000x08001000", "02"},
                                                                                        {"MD00001080x1000", "03"},
                                                                                        {"MD0000108101000", "04"},
                                                                                        {"MD0010000901000", "05"},
                                                                                        {"MD000010800100x", "07"},
                                                                                        {"MD000010800", "0C"},
                                                                                        {"GD00001080010", "0C"}}) {
    EXPECT_EQ(said(request + "\n"), answer(request, status));
  }
}

TEST_F(EmulatedScip, CountsDownAStreamWithAnEnd) {
  EXPECT_EQ(said("MD0538054201002\n"), answer("MD0538054201002", "00"));
  const std::string scans = said_until(now_ns_ + 200 * kMs);
  EXPECT_THAT(scans, StartsWith("MD0538054201001\n99b\n"));
  EXPECT_THAT(scans, HasSubstr("\n\nMD0538054201000\n99b\n"));
  EXPECT_THAT(said_until(now_ns_ + 200 * kMs), "");
}

TEST_F(EmulatedScip, GivesOneScanWhenAsked) {
  static_cast<void>(said("BM\n"));
  const std::string scan = said("GS0540054001\n");
  EXPECT_THAT(scan, StartsWith("GS0540054001\n00P\n"));
  EXPECT_EQ(scan.size(), std::string("GS0540054001\n00P\n0000s\nXXs\n\n").size());
}

TEST_F(EmulatedScip, CutsDataIntoLinesOf64) {
  const std::string data(64, '0');
  EXPECT_EQ(scip::data_lines(data), scip::summed(data));
  EXPECT_EQ(scip::data_lines(data + "1"), scip::summed(data) + scip::summed("1"));
  EXPECT_EQ(scip::data_lines(""), "");
}

TEST_F(EmulatedScip, ScansKeepToTheMirrorsTime) {
  static_cast<void>(said("MD0000108001000\n"));
  const std::int64_t start_ns = now_ns_;
  std::vector<std::int64_t> stamps_ns;
  for (; now_ns_ < start_ns + test::kSecond; now_ns_ += kMs) {
    device_.tick(now_ns_);
    for (const SentBytes& sent : device_.take_output()) {
      stamps_ns.push_back(sent.scan->first_beam_ns);
      EXPECT_GE(now_ns_ - stamps_ns.back(), model_.time_to_step_ns(1080));
      EXPECT_LE(now_ns_ - stamps_ns.back(), model_.time_to_step_ns(1080) + kMs);
    }
  }
  ASSERT_EQ(stamps_ns.size(), 40U);
  for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
    EXPECT_EQ(stamps_ns[i], start_ns + static_cast<std::int64_t>(i) * 25 * kMs);
  }
}

TEST(EmulatedUrg, SpeaksScip1UntilItIsTold) {
  const ScipModel model = *find_scip_model("urg-04lx");
  WorldSource source(model.turn_ns(), test::small_drive());
  ScipDevice device(model, source, {}, 0);
  device.receive("QT\nSCIP2.0\nQT\n", 0);
  std::string all;
  for (const SentBytes& sent : device.take_output()) {
    all += sent.bytes;
  }
  EXPECT_EQ(all, "QT\nE\n\nSCIP2.0\n0\n\nQT\n00P\n\n");
}

}  // namespace
}  // namespace odoless
