// Emulated devices and clients that say what no client should: none stops to answer, or breaks.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/rng.hpp"
#include "drivers/lrf/sick/telegram.hpp"
#include "tests/support/servo_support.hpp"
#include "tests/tools/emulate_support.hpp"

namespace odoless {
namespace {

using test::kMs;
using test::kSecond;

std::string random_bytes(Rng& rng, std::uint32_t most) {
  std::string bytes(rng.below(most + 1), '\0');
  for (char& c : bytes) {
    c = static_cast<char>(rng.below(4) == 0 ? 0xFF - rng.below(3) : rng.below(256));
  }
  return bytes;
}

/// A request of the protocol with anything in it.
using Request = std::string (*)(Rng& rng);

std::string scip_request(Rng& rng) {
  static const std::vector<std::string> kCommands{"MD", "ME", "MS", "ND", "NE", "GD", "HD", "TM", "SS",     "CR",
                                                  "HS", "RB", "QT", "RS", "BM", "VV", "PP", "II", "SCIP2.0"};
  std::string line = kCommands[rng.below(static_cast<std::uint32_t>(kCommands.size()))];
  for (std::uint32_t i = rng.below(16); i > 0; --i) {
    line += static_cast<char>(rng.below(8) == 0 ? rng.below(256) : '0' + rng.below(10));
  }
  return line + '\n';
}

std::string sick_request(Rng& rng) {
  static const std::string kCommands("\x10\x20\x20\x20\x30\x31\x36\x37\x3A\x3B\x3F\x74\x77", 13);
  std::string payload(1, kCommands[rng.below(static_cast<std::uint32_t>(kCommands.size()))]);
  if (payload[0] == '\x20' && rng.below(2) == 0) {
    payload += static_cast<char>(0x24 + rng.below(8));
  }
  payload += random_bytes(rng, 8);
  const sick::Request request(std::as_bytes(std::span(payload.data(), payload.size())));
  return {reinterpret_cast<const char*>(request.bytes().data()), request.bytes().size()};
}

std::string rplidar_request(Rng& rng) {
  static const std::string kCommands("\x20\x21\x25\x40\x50\x52\x59\x82\x84\xA8\xF0\xFF", 12);
  std::string text = "\xA5";
  text += kCommands[rng.below(static_cast<std::uint32_t>(kCommands.size()))];
  if ((static_cast<unsigned char>(text[1]) & 0x80U) != 0) {
    const std::string payload = random_bytes(rng, 40);
    text += static_cast<char>(payload.size());
    text += payload;
    char sum = 0;
    for (const char c : text) {
      sum = static_cast<char>(sum ^ c);
    }
    text += sum;
  }
  return text;
}

std::string sopas_content(Rng& rng) {
  static const std::vector<std::string> kHeads{"sRN LMDscandata",    "sRN LMPscancfg",
                                               "sRN LMPoutputRange", "sRN DeviceIdent",
                                               "sEN LMDscandata",    "sWN LMDscandatacfg",
                                               "sWN LMPoutputRange", "sMN mLMPsetscancfg",
                                               "sMN SetAccessMode",  "sMN Run",
                                               "sMN LMCstartmeas",   "sXX"};
  return kHeads[rng.below(static_cast<std::uint32_t>(kHeads.size()))];
}

std::string cola_a_request(Rng& rng) {
  std::string text = sopas_content(rng);
  for (std::uint32_t word = rng.below(8); word > 0; --word) {
    text += fmt::format(" {:X}", rng.below(4) == 0 ? rng.below(0xFFFFFFFFU) : rng.below(20));
  }
  return '\x02' + text + '\x03';
}

std::string cola_b_request(Rng& rng) {
  const std::string content = sopas_content(rng) + ' ' + random_bytes(rng, 24);
  char sum = 0;
  for (const char c : content) {
    sum = static_cast<char>(sum ^ c);
  }
  return std::string("\x02\x02\x02\x02\0\0\0", 7) + static_cast<char>(content.size()) + content + sum;
}

struct Hostile {
  const char* model;
  Request request;
  const char* question;  ///< that is answered in the end, after a device without power had it again
  std::size_t question_bytes;
  friend void PrintTo(const Hostile& hostile, std::ostream* out) { *out << hostile.model; }
};

class HostileClientOfLaser : public ::testing::TestWithParam<Hostile> {};

TEST_P(HostileClientOfLaser, IsSurvived) {
  const auto& [model, request, question, question_bytes] = GetParam();
  WorldSource source(test::period_ns_of(model), test::small_drive());
  const auto device = make_emulated_lrf(model, source, {}, 0);
  Rng rng(21);
  std::int64_t now_ns = 0;
  for (int i = 0; i < 4000; ++i, now_ns += kMs) {
    std::string said = request(rng);
    if (rng.below(5) == 0) {
      said.insert(rng.below(static_cast<std::uint32_t>(said.size())), random_bytes(rng, 3));
    }
    device->receive(said, now_ns);
    device->tick(now_ns);
    static_cast<void>(device->take_output());
  }
  device->set_power(false, now_ns);
  device->set_power(true, now_ns);
  now_ns += 3 * kSecond;
  device->tick(now_ns);
  static_cast<void>(device->take_output());
  device->receive({question, question_bytes}, now_ns);
  std::string answer;
  for (const std::int64_t end_ns = now_ns + kSecond; now_ns < end_ns; now_ns += kMs) {
    device->tick(now_ns);
    for (const SentBytes& sent : device->take_output()) {
      answer += sent.bytes;
    }
  }
  EXPECT_GT(answer.size(), 8U);
}

INSTANTIATE_TEST_SUITE_P(Lasers, HostileClientOfLaser,
                         ::testing::Values(Hostile{"utm-30lx-ew", scip_request, "VV\n", 3},
                                           Hostile{"urg-04lx", scip_request, "SCIP2.0\nVV\n", 11},
                                           Hostile{"lms291", sick_request, "\x02\x00\x01\x00\x31\x15\x12", 7},
                                           Hostile{"lms291-quarter", sick_request, "\x02\x00\x01\x00\x31\x15\x12", 7},
                                           Hostile{"rplidar-a2", rplidar_request, "\xA5\x50", 2},
                                           Hostile{"rplidar-a1-1.16", rplidar_request, "\xA5\x50", 2},
                                           Hostile{"ydlidar-x4", rplidar_request, "\xA5\x90", 2},
                                           Hostile{"lms111", cola_a_request, "\x02sRN DeviceIdent\x03", 17},
                                           Hostile{"lms4124", cola_b_request,
                                                   "\x02\x02\x02\x02\0\0\0\x0FsRN DeviceIdent\x25", 24}),
                         [](const auto& tested) {
                           std::string name = tested.param.model;
                           std::replace_if(
                               name.begin(), name.end(), [](char c) { return c == '-' || c == '.'; }, '_');
                           return name;
                         });

TEST(HostileClientOfDrive, IsSurvived) {
  Cia402DeviceOptions options;
  Cia402Device device(options, 0);
  Rng rng(22);
  std::int64_t now_ns = 0;
  for (int i = 0; i < 60'000; ++i, now_ns += kMs / 4) {
    static const std::vector<std::uint32_t> kIds{0x000, 0x080, 0x201, 0x301, 0x601, 0x601, 0x601, 0x601, 0x77F};
    static const std::vector<std::uint32_t> kIndices{0x1000, 0x1003, 0x1005, 0x1008, 0x1014, 0x1016, 0x1017, 0x1029,
                                                     0x1400, 0x1600, 0x1800, 0x1A00, 0x6007, 0x6040, 0x605A, 0x6060,
                                                     0x607A, 0x607D, 0x6081, 0x6083, 0x6085, 0x6098, 0x6099, 0x60FF};
    CanFrame frame;
    frame.id = kIds[rng.below(static_cast<std::uint32_t>(kIds.size()))];
    frame.size_bytes = static_cast<std::uint8_t>(rng.below(5) == 0 ? rng.below(9) : 8);
    for (std::uint8_t& byte : frame.data) {
      byte = static_cast<std::uint8_t>(rng.below(3) == 0 ? rng.below(256) : rng.below(3));
    }
    if (frame.id == 0x601 && rng.below(4) != 0) {
      frame.data[0] = std::array<std::uint8_t, 6>{0x40, 0x2F, 0x2B, 0x23, 0x21, 0x22}.at(rng.below(6));
      canopen::put(frame, 1, kIndices[rng.below(static_cast<std::uint32_t>(kIndices.size()))], 2);
      frame.data[3] = static_cast<std::uint8_t>(rng.below(6));
    }
    device.receive(as_bytes(frame), now_ns);
    static_cast<void>(device.take_output());
    ASSERT_TRUE(std::isfinite(device.angle_rad()));
  }
  device.receive(as_bytes(canopen::nmt(canopen::NmtCommand::kResetNode, 1)), now_ns);
  static_cast<void>(device.take_output());
  device.receive(as_bytes(canopen::sdo_read(1, {0x1000, 0})), now_ns);
  ASSERT_EQ(device.take_output().size(), 1U);
}

TEST(HostileClientOfDynamixel, IsSurvived) {
  DynamixelDevice device({}, 0);
  Rng rng(23);
  std::int64_t now_ns = 0;
  for (int i = 0; i < 60'000; ++i, now_ns += kMs / 4) {
    static const std::vector<std::uint8_t> kInstructions{1,    2,    3,    3,    4,    5,    6,    8,   16,
                                                         0x82, 0x83, 0x8A, 0x92, 0x93, 0x9A, 0x55, 0x20};
    std::vector<std::uint8_t> parameters;
    for (std::uint32_t left = rng.below(24); left > 0; --left) {
      parameters.push_back(static_cast<std::uint8_t>(rng.below(3) == 0 ? 0xFF - rng.below(4) : rng.below(255)));
    }
    if (parameters.size() > 2 && rng.below(2) == 0) {
      parameters[1] = 0;
    }
    const int id = rng.below(2) == 0 ? 0xFE : static_cast<int>(device.get(DynamixelTable::kId, 1));
    const auto instruction = kInstructions[rng.below(static_cast<std::uint32_t>(kInstructions.size()))];
    const dynamixel::PacketBytes packet =
        dynamixel::encode(id, static_cast<dynamixel::Instruction>(instruction), parameters);
    device.receive(std::as_bytes(packet.span()), now_ns);
    static_cast<void>(device.take_output());
    ASSERT_TRUE(std::isfinite(device.angle_rad()));
  }
  now_ns += kSecond;
  device.tick(now_ns);
  static_cast<void>(device.take_output());
  const dynamixel::PacketBytes ping = dynamixel::encode(0xFE, dynamixel::Instruction::kPing, {});
  device.receive(std::as_bytes(ping.span()), now_ns);
  device.tick(now_ns + kSecond);
  EXPECT_EQ(device.take_output().size(), 1U);
}

TEST(HostileClientOfMaestro, IsSurvived) {
  MaestroDevice device({}, 0);
  Rng rng(24);
  std::int64_t now_ns = 0;
  for (int i = 0; i < 60'000; ++i, now_ns += kMs / 4) {
    static const std::string kCommands("\x84\x87\x89\x90\x93\xA1\xA2\x9F\xAA\xFF", 10);
    std::string said(1, kCommands[rng.below(static_cast<std::uint32_t>(kCommands.size()))]);
    for (std::uint32_t left = rng.below(6); left > 0; --left) {
      said += static_cast<char>(rng.below(3) == 0 ? rng.below(256) : rng.below(8));
    }
    device.receive(std::as_bytes(std::span(said)), now_ns);
    static_cast<void>(device.take_output());
    ASSERT_TRUE(std::isfinite(device.angle_rad()));
  }
  device.tick(now_ns += kSecond);
  static_cast<void>(device.take_output());
  // Six bytes of nothing end whatever it is at; then it is asked for its errors.
  const std::string question("\xA1\xA1\xA1\xA1\xA1\xA1", 6);
  device.receive(std::as_bytes(std::span(question)), now_ns);
  device.tick(now_ns + kSecond);
  EXPECT_FALSE(device.take_output().empty());
}

}  // namespace
}  // namespace odoless
