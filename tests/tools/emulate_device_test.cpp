// What the emulated laser answers, by the protocol's description.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <utility>
#include <vector>

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
  explicit EmulatedScip(const char* model = "utm-30lx") : model_(*find_scip_model(model)) {}

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
  ScipModel model_;
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

// As lasers do that are newer than the protocol's paper.
TEST_F(EmulatedScip, TellsItsTimeInEveryMode) {
  now_ns_ += 1234 * kMs;
  const std::string time = "TM1\n00P\n" + scip::summed("00CB") + "\n";
  EXPECT_EQ(said("TM1\n"), time);
  EXPECT_EQ(said("TM2\n"), answer("TM2", "03"));
  EXPECT_EQ(said("TM0\n"), answer("TM0", "00"));
  EXPECT_EQ(said("TM0\n"), answer("TM0", "02"));
  EXPECT_EQ(said("TM1\n"), time);
  EXPECT_THAT(said("TM1;tag\n"), StartsWith("TM1;tag\n00P\n"));
  EXPECT_EQ(said("TM2\n"), answer("TM2", "00"));
  EXPECT_EQ(said("TM9\n"), answer("TM9", "01"));
}

TEST_F(EmulatedScip, TellsOfItselfInTimeModeAndDoesNothingElse) {
  EXPECT_EQ(said("TM0\n"), answer("TM0", "00"));
  EXPECT_THAT(said("VV\n"), StartsWith("VV\n00P\nVEND:"));
  EXPECT_THAT(said("PP\n"), StartsWith("PP\n00P\nMODL:"));
  EXPECT_THAT(said("II\n"), StartsWith("II\n00P\nMODL:"));
  for (const std::string refused : {"QT", "BM", "MD0000108001000", "SS115200"}) {
    EXPECT_EQ(said(refused + "\n"), answer(refused, "10"));
  }
  EXPECT_EQ(said("RS\n"), answer("RS", "00"));
  EXPECT_EQ(said("TM2\n"), answer("TM2", "03")) << "a reset has left it";
}

TEST_F(EmulatedScip, DoesNotLeaveAStreamForTimeMode) {
  EXPECT_EQ(said("MD0000108001000\n"), answer("MD0000108001000", "00"));
  EXPECT_EQ(said("TM0\n"), answer("TM0", "10"));
  EXPECT_EQ(said("QT\n"), answer("QT", "00"));
  EXPECT_EQ(said("TM0\n"), answer("TM0", "00"));
}

TEST_F(EmulatedScip, IsRebootedByTwoRequestsWithinASecond) {
  EXPECT_EQ(said("RB\n"), answer("RB", "01"));
  now_ns_ += 1100 * kMs;
  EXPECT_EQ(said("RB\n"), answer("RB", "01")) << "too late";
  EXPECT_EQ(said("BM\n"), answer("BM", "00"));
  now_ns_ += 900 * kMs;
  EXPECT_EQ(said("RB\n"), answer("RB", "00"));
  now_ns_ += kMs;
  EXPECT_EQ(said("VV\n"), "") << "it boots";
  now_ns_ += 2000 * kMs;
  EXPECT_THAT(said("II\n"), HasSubstr("LASR:OFF;"));
  EXPECT_THAT(said("II\n"), HasSubstr("TIME:0007D1;")) << "and its clock began anew";
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

class EmulatedUrg : public EmulatedScip {
 protected:
  EmulatedUrg() : EmulatedScip("urg-04lx") {}
};

TEST_F(EmulatedUrg, SpeaksScip1UntilItIsTold) {
  EXPECT_EQ(said("QT\nSCIP2.0\nQT\n"), "QT\nE\n\nSCIP2.0\n0\n\nQT\n00P\n\n");
}

// Hokuyo's paper on SCIP 2.0, 8.6: no other command until the mode is left.
TEST_F(EmulatedUrg, KeepsTimeModeApart) {
  static_cast<void>(said("SCIP2.0\n"));
  EXPECT_EQ(said("TM1\n"), answer("TM1", "04"));
  EXPECT_EQ(said("TM2\n"), answer("TM2", "03"));
  EXPECT_EQ(said("TM0\n"), answer("TM0", "00"));
  EXPECT_EQ(said("TM0\n"), answer("TM0", "02"));
  for (const std::string refused : {"QT", "VV", "BM"}) {
    EXPECT_EQ(said(refused + "\n"), answer(refused, "0E"));
  }
  now_ns_ += 1234 * kMs;
  EXPECT_EQ(said("TM1\n"), "TM1\n00P\n" + scip::summed("00CB") + "\n");
  EXPECT_EQ(said("TM2\n"), answer("TM2", "00"));
  EXPECT_EQ(said("TM9\n"), answer("TM9", "01"));
  EXPECT_EQ(said("RB\n"), answer("RB", "0E"));
}

class EmulatedMultiEcho : public EmulatedScip {
 protected:
  EmulatedMultiEcho() : EmulatedScip("utm-30lx-ew") {}

  /// The values of each step's echoes, of a reply with `values` numbers an echo.
  static std::vector<std::vector<int>> steps_of(const std::string& reply, std::size_t lines_before, int values) {
    std::vector<std::vector<int>> steps;
    std::string data;
    std::istringstream lines(reply);
    std::string line;
    for (std::size_t i = 0; std::getline(lines, line) && (i < lines_before || !line.empty()); ++i) {
      data += i < lines_before ? "" : line.substr(0, line.size() - 1);
    }
    for (std::size_t at = 0; at < data.size();) {
      const bool goes_on = data[at] == '&';
      at += goes_on ? 1U : 0U;
      if (!goes_on) {
        steps.emplace_back();
      }
      for (int k = 0; k < values; ++k, at += 3) {
        int value = 0;
        for (std::size_t i = 0; i < 3; ++i) {
          value = value << 6 | (data.at(at + i) - '0');
        }
        steps.back().push_back(value);
      }
    }
    return steps;
  }
};

TEST_F(EmulatedMultiEcho, TellsAllEchoesOfABeamTheNearestFirst) {
  EXPECT_EQ(said("ND0000108001001\n"), answer("ND0000108001001", "00"));
  const std::string scan = said_until(now_ns_ + 60 * kMs);
  EXPECT_THAT(scan, StartsWith("ND0000108001000\n99b\n"));
  const auto steps = steps_of(scan, 3, 1);
  ASSERT_EQ(steps.size(), 1081U);
  int edges = 0;
  for (const std::vector<int>& echoes : steps) {
    ASSERT_LE(echoes.size(), 2U);
    edges += echoes.size() == 2 ? 1 : 0;
    EXPECT_TRUE(echoes.size() == 1 || echoes[0] + 190 < echoes[1]) << echoes[0] << " " << echoes[1];
  }
  EXPECT_GE(edges, 1) << "the box has an edge in sight";
  EXPECT_LE(edges, 8);
}

TEST_F(EmulatedMultiEcho, TellsEchoesWithIntensitiesAndOneScanWhenAsked) {
  EXPECT_EQ(said("NE0000108001001\n"), answer("NE0000108001001", "00"));
  EXPECT_EQ(steps_of(said_until(now_ns_ + 60 * kMs), 3, 2).size(), 1081U);
  EXPECT_EQ(said("BM\n"), answer("BM", "00"));
  EXPECT_EQ(steps_of(said("HD0000108001\n"), 3, 1).size(), 1081U);
  EXPECT_EQ(steps_of(said("HE0000108001\n"), 3, 2).size(), 1081U);
  EXPECT_EQ(said("NS0000108001001\n"), answer("NS0000108001001", "0E"));
  EXPECT_EQ(said("HS1\n"), answer("HS1", "00")) << "another command";
}

TEST_F(EmulatedScip, KnowsNoEchoesIfItHasOne) { EXPECT_EQ(said("ND0000108001001\n"), answer("ND0000108001001", "0E")); }

}  // namespace
}  // namespace odoless
