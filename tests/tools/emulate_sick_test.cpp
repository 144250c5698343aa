// A SICK session against the emulated laser.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "drivers/lrf/sick/sick_session.hpp"
#include "drivers/lrf/sick/telegram.hpp"
#include "tests/tools/emulate_stream.hpp"
#include "tools/emulate/sick_device.hpp"

namespace odoless {
namespace {

using test::Bench;
using test::kMs;
using test::kSecond;

LrfParams sick_params(int baud = 500000, SickVariant variant = SickVariant::k180ByHalf) {
  LrfParams params;
  params.driver = LrfDriver::kSick;
  params.baud = baud;
  params.sick_variant = variant;
  return params;
}

std::string request(std::string_view payload) {
  const sick::Request made(std::as_bytes(std::span(payload.data(), payload.size())));
  return {reinterpret_cast<const char*>(made.bytes().data()), made.bytes().size()};
}

SickDevice& device_of(Bench& bench) { return static_cast<SickDevice&>(bench.device()); }

/// Every scan that was heard is one that was sent, beam by beam, with its time.
void expect_scans_true(Bench& bench, const LrfParams& params, std::int64_t stamp_error_max_ns) {
  const std::vector<EmulatedBeam> beams = sick_beams(sick::variant_of(params.sick_variant));
  std::vector<double> true_m(beams.size());
  const double resolution_m = params.sick_unit == SickUnit::kMm ? 0.00051 : 0.0051;
  for (const test::HeardScan& scan : bench.heard().scans) {
    const SentScan* nearest = nullptr;
    for (const SentScan& sent : bench.sent()) {
      nearest = std::abs(sent.first_beam_ns - scan.stamp_ns) <= stamp_error_max_ns ? &sent : nearest;
    }
    ASSERT_NE(nearest, nullptr) << "no scan was sent with the stamp " << scan.stamp_ns;
    bench.source().measure(nearest->index, beams, true_m);
    ASSERT_EQ(scan.ranges_m.size(), true_m.size());
    for (std::size_t i = 0; i < true_m.size(); ++i) {
      ASSERT_NEAR(scan.ranges_m[i], true_m[i], resolution_m) << "beam " << i;
    }
  }
}

TEST(SickSession, BringsEveryVariantUpAtEveryRateAndHearsItsScans) {
  for (const SickVariant variant : {SickVariant::k180By1, SickVariant::k180ByHalf, SickVariant::k100By1,
                                    SickVariant::k100ByHalf, SickVariant::k100ByQuarter}) {
    for (const int baud : {9600, 19200, 38400, 500000, 0}) {
      SCOPED_TRACE(std::string(kSickVariantNames[static_cast<std::size_t>(variant)]) + " at " + std::to_string(baud));
      const LrfParams params = sick_params(baud, variant);
      Bench bench("lms291", {}, params);
      bench.reset();
      bench.run(6 * kSecond);
      ASSERT_TRUE(bench.session().ready());
      EXPECT_EQ(bench.session().line_baud(), baud == 0 ? 9600 : baud);
      const LrfGeometry& geometry = bench.session().geometry();
      EXPECT_EQ(geometry.beams, sick::variant_of(variant).beams());
      EXPECT_NEAR(geometry.start_angle_rad + 0.5 * (geometry.beams - 1) * geometry.angle_step_rad, 0.0, 1e-6);
      EXPECT_GT(bench.heard().scans.size(), static_cast<std::size_t>(4 * kSecond / geometry.period_ns) - 2U);
      EXPECT_EQ(bench.session().counters().rejected, 0U);
      EXPECT_EQ(bench.heard().scans[0].beam_period_ns, sick::variant_of(variant).turns() == 1 ? sick::kTurnNs / 360 : 0)
          << "of smaller steps, the beams come in turns";
      expect_scans_true(bench, params, 2 * kMs);
    }
  }
}

TEST(SickSession, ComesToTheStreamFromEveryStateAndRate) {
  for (const std::string& before : {std::string(), request("\x20\x24"), request("\x20\x48"), request("\x20\x40"),
                                    request(std::string("\x20\x00SICK_LMS", 10)), request("\x31").substr(0, 4),
                                    request("\x20\x48") + request("\x20\x24"), std::string("\x02\x00\x20", 3)}) {
    for (const int baud : {38400, 500000}) {
      Bench bench("lms200", {}, sick_params(baud));
      bench.say(before);
      bench.run(50 * kMs);
      bench.reset();
      bench.run(8 * kSecond);
      EXPECT_TRUE(bench.session().ready());
      EXPECT_EQ(bench.session().line_baud(), baud);
      EXPECT_GE(bench.heard().scans.size(), 4U);
    }
  }
}

TEST(SickSession, WritesItsConfigurationOnlyWhenItMust) {
  for (const SickUnit unit : {SickUnit::kMm, SickUnit::kCm}) {
    LrfParams params = sick_params();
    params.sick_unit = unit;
    Bench bench("lms291", {}, params);
    for (int i = 0; i < 3; ++i) {
      bench.reset();
      bench.run(3 * kSecond);
      ASSERT_TRUE(bench.session().ready());
    }
    EXPECT_EQ(device_of(bench).writes(), unit == SickUnit::kMm ? 1 : 0);
    expect_scans_true(bench, params, 2 * kMs);
  }
}

TEST(SickSession, OnlyAskedLeavesADeviceAsItIs) {
  const std::string streams = request("\x20\x24");
  for (const auto& [model, variant] :
       {std::pair("lms200", SickVariant::k180By1), std::pair("lms291", SickVariant::k180ByHalf),
        std::pair("lms291-quarter", SickVariant::k100ByQuarter)}) {
    for (const auto& [before, baud] :
         {std::pair(std::string(), 9600), std::pair(streams, 9600), std::pair(request("\x20\x40"), 38400),
          std::pair(request("\x20\x48") + streams, 500000)}) {
      Bench bench(model, {}, sick_params(0, SickVariant::k100By1));
      auto& session = static_cast<SickSession&>(bench.session());
      session.only_ask();
      bench.say(before);
      bench.run(500 * kMs);
      bench.reset();
      for (int i = 0; i < 500 && !session.ready(); ++i) {
        bench.run(10 * kMs);
      }
      ASSERT_TRUE(session.ready()) << model;
      EXPECT_EQ(session.found().variant, variant);
      EXPECT_EQ(session.found().unit, SickUnit::kCm);
      EXPECT_TRUE(session.found().is_usual_mode);
      EXPECT_EQ(session.geometry().beams, sick::variant_of(variant).beams());
      EXPECT_NEAR(session.geometry().range_max_m, 81.83, 1e-9) << "of cm";
      EXPECT_EQ(session.line_baud(), baud);
      EXPECT_EQ(device_of(bench).writes(), 0);
      for (const std::string& change :
           {request(std::string("\x20\x00SICK_LMS", 10)), std::string("\x3B\x64"), streams, request("\x10")}) {
        EXPECT_EQ(bench.written().find(change), std::string::npos);
      }
    }
  }
}

TEST(SickSession, OnlyAskedTellsWhatWasWrittenBefore) {
  Bench bench("lms291", {}, sick_params(500000, SickVariant::k100By1));  // in mm
  bench.reset();
  bench.run(3 * kSecond);
  ASSERT_EQ(device_of(bench).writes(), 1);
  auto& session = static_cast<SickSession&>(bench.session());
  session.only_ask();
  bench.reset();
  bench.run(300 * kMs);
  ASSERT_TRUE(session.ready());
  EXPECT_EQ(session.found().variant, SickVariant::k100By1);
  EXPECT_EQ(session.found().unit, SickUnit::kMm);
  EXPECT_TRUE(session.found().is_usual_mode);
  EXPECT_EQ(device_of(bench).writes(), 1);
}

// The rate of a serial device server is the server's: line and laser are left alone, and `baud` says what it is.
TEST(SickSession, StampsAreRightOverADeviceServer) {
  for (const auto& [baud, command] :
       {std::pair(9600, "\x20\x42"), std::pair(38400, "\x20\x40"), std::pair(500000, "\x20\x48")}) {
    SCOPED_TRACE(baud);
    LrfParams params = sick_params(baud);
    params.device = "tcp://127.0.0.1:4001";
    Bench bench("lms291", {}, params);
    bench.say(request(command));
    bench.reset();
    bench.run(8 * kSecond);
    EXPECT_TRUE(bench.session().ready());
    EXPECT_EQ(bench.session().line_baud(), 0) << "or its owner would set it";
    EXPECT_GE(bench.heard().scans.size(), 5U);
    EXPECT_EQ(bench.session().counters().restarts, 0U);
    EXPECT_EQ(bench.written().find(request(command)), std::string::npos);
    expect_scans_true(bench, params, 2 * kMs);
  }
}

TEST(SickSession, StreamsOverADeviceServerOfUnknownRateWithLateStamps) {
  for (const auto& [baud, command] : {std::pair(9600, "\x20\x42"), std::pair(38400, "\x20\x40")}) {
    LrfParams params = sick_params(0);
    params.device = "tcp://127.0.0.1:4001";
    Bench bench("lms291", {}, params);
    bench.say(request(command));
    bench.reset();
    bench.run(8 * kSecond);
    EXPECT_EQ(bench.session().counters().restarts, 0U) << "a slow line is no stall";
    ASSERT_GE(bench.heard().scans.size(), 5U);
    ASSERT_EQ(bench.heard().scans.size(), bench.sent().size());
    const std::int64_t transfer_ns = 732 * 10 * kSecond / baud;
    const std::int64_t late_ns = bench.heard().scans.back().stamp_ns - bench.sent().back().first_beam_ns;
    EXPECT_NEAR(static_cast<double>(late_ns), static_cast<double>(transfer_ns), 2.0 * kMs);
  }
}

TEST(SickSession, TellsNoReturnFromWhatCannotBeSaid) {
  sick::ScanStream stream(sick_params(), 500);
  ASSERT_EQ(stream.configure(38400), Errc::kOk);
  std::vector<std::byte> payload(stream.variant().payload_bytes());
  payload[0] = std::byte{0xB0};
  payload[1] = std::byte{0x69};  // 361 beams
  payload[2] = std::byte{0x41};  // in mm
  const auto set = [&](std::size_t beam, unsigned value) {
    payload[3 + 2 * beam] = static_cast<std::byte>(value & 0xFFU);
    payload[4 + 2 * beam] = static_cast<std::byte>(value >> 8U);
  };
  const std::vector<unsigned> values{0x7FF7, 0x7FF8, 0x7FFA, 0x7FFB, 0x7FFD, 0x7FFE, 0x7FFF, 0x7FF6, 0x8000 + 1234};
  for (std::size_t i = 0; i < values.size(); ++i) {
    set(i, values[i]);
  }
  const Result<LrfScan> scan = stream.scan({payload}, kSecond);
  ASSERT_TRUE(scan.ok());
  EXPECT_TRUE(std::isinf(scan.value().ranges_m[0]));
  for (std::size_t i = 1; i < 7; ++i) {
    EXPECT_EQ(scan.value().ranges_m[i], 0.0F) << i;
  }
  EXPECT_FLOAT_EQ(scan.value().ranges_m[7], 32.758F);
  EXPECT_FLOAT_EQ(scan.value().ranges_m[8], 1.234F) << "the highest bit tells of a field";
}

TEST(SickSession, RefusesAVariantWithMoreBeamsThanThereIsRoomFor) {
  const sick::Variant quarter = sick::variant_of(SickVariant::k100ByQuarter);
  LrfParams params = sick_params(0, SickVariant::k100ByQuarter);
  sick::ScanStream stream(params, quarter.beams() - 1);
  EXPECT_EQ(stream.configure(9600), Errc::kTooManyBeams);
}

TEST(SickSession, StampsAreEvenWhenBytesComeLate) {
  Rng rng(4);
  sick::ScanStream stream(sick_params(), 500);
  ASSERT_EQ(stream.configure(500000), Errc::kOk);
  std::vector<std::byte> payload(stream.variant().payload_bytes());
  payload[1] = std::byte{0x69};
  payload[2] = std::byte{0x41};
  const std::int64_t way_ns = sick::kTurnNs * 3 / 2 + 14'640'000;
  double worst_ms = 0.0;
  for (std::int64_t scan = 0; scan < 800; ++scan) {
    const std::int64_t true_ns = 5000 * kSecond + scan * 2 * 13'340'000;  // the mirror turns 0.05 % slower than it says
    const auto late_ns = static_cast<std::int64_t>(rng.uniform(0.0, 5e6));
    const Result<LrfScan> heard = stream.scan({payload}, true_ns + way_ns + late_ns);
    ASSERT_TRUE(heard.ok());
    if (scan > 40) {
      worst_ms = std::max(worst_ms, std::abs(static_cast<double>(heard.value().stamp_ns - true_ns)) * 1e-6);
    }
  }
  EXPECT_LT(worst_ms, 1.5);
}

class SickSessionFault : public ::testing::TestWithParam<test::FaultCase> {};

// Two seconds into the stream, a fault; in the end the stream runs again, and no scan that was heard is wrong.
TEST_P(SickSessionFault, IsSurvived) {
  const LrfParams params = sick_params();
  Bench bench("lms291", {.faults = {parse_fault(GetParam().fault)}}, params);
  bench.reset();
  bench.run(15 * kSecond);
  EXPECT_TRUE(bench.session().ready());
  const std::int64_t first_ns = bench.heard().scans.front().stamp_ns;
  const auto sent = static_cast<int>((bench.now_ns() - first_ns) / (2 * sick::kTurnNs));
  EXPECT_LE(sent - static_cast<int>(bench.heard().scans.size()), GetParam().scans_lost_max);
  EXPECT_LT(bench.now_ns() - bench.heard().scans.back().arrival_ns, 60 * kMs);
  expect_scans_true(bench, params, 4 * kMs);
}

INSTANTIATE_TEST_SUITE_P(Sick, SickSessionFault,
                         ::testing::Values(test::FaultCase{"silence@2:1", 80}, test::FaultCase{"garbage@2:1", 120},
                                           test::FaultCase{"truncate@2:0.2", 12},
                                           test::FaultCase{"wrong-sum@2:0.2", 12}, test::FaultCase{"wrong-sum@2:1", 80},
                                           test::FaultCase{"reboot@2", 220}, test::FaultCase{"beams@2:0.2", 12},
                                           test::FaultCase{"one-byte@2:1", 3}),
                         test::fault_name);

TEST(SickSession, ResetsADeviceThatSaysItIsBroken) {
  Bench bench("lms291", {}, sick_params());
  bench.on_the_way = [&](std::string& bytes) {
    if (bytes.size() > 700 && bench.heard().scans.size() == 20) {
      bytes[bytes.size() - 3] = 4;  // fatal
      bytes.resize(bytes.size() - 2);
      const std::uint16_t sum = sick::checksum(std::as_bytes(std::span(bytes.data(), bytes.size())));
      bytes += static_cast<char>(sum & 0xFFU);
      bytes += static_cast<char>(sum >> 8U);
    }
  };
  bench.reset();
  bench.run(8 * kSecond);
  EXPECT_TRUE(bench.session().ready());
  EXPECT_EQ(bench.heard().count(LrfEventType::kDeviceError), 1);
  EXPECT_THAT(bench.written(), ::testing::HasSubstr(request("\x10")));
  EXPECT_EQ(bench.session().counters().device_errors, 1U);
}

TEST(SickRobustness, OneDamagedByteAnywhereCostsAtMostOneScan) {
  const test::Stream stream("lms200", sick_params(500000, SickVariant::k100By1), 90 * kMs);
  const std::vector<test::HeardScan> sent = heard_from(stream, stream.scans());
  ASSERT_GE(sent.size(), 4U);
  ASSERT_EQ(sent.size(), stream.pieces());
  Rng rng(3);
  std::map<std::size_t, int> tries;
  const std::size_t scan_bytes = stream.scans().size() / stream.pieces();
  for (const auto& [name, mutate] : test::kMutations) {
    for (std::size_t at = scan_bytes; at < 2 * scan_bytes + 10; ++at) {
      const std::vector<test::HeardScan> heard = heard_from(stream, mutate(stream.scans(), at, rng));
      ASSERT_TRUE(are_among(heard, sent)) << name << " at " << at << ": a wrong scan";
      ASSERT_GE(heard.size() + 1, sent.size()) << name << " at " << at;
      ++tries[sent.size() - heard.size()];
    }
  }
  EXPECT_GT(tries[1], tries[0]) << "most damage must be seen";
}

TEST(SickRobustness, AnySplitGivesTheSame) {
  test::expect_any_split_gives_the_same({"lms200", sick_params(500000, SickVariant::k180By1), 90 * kMs}, 50, 1500);
}

TEST(SickRobustness, NoiseNeverEndsTheSession) {
  const std::string alphabet("\x02\x80\xD6\x02\xB0\x69\x41\x06\x15\xA0\x00\xB1\x90", 13);
  test::expect_noise_never_ends(sick_params(), alphabet, 48);
}

}  // namespace
}  // namespace odoless
