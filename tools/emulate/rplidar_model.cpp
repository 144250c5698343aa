#include "tools/emulate/rplidar_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/lrf/rplidar/capsule.hpp"

namespace odoless {
namespace {

using rplidar::kDenseType;
using rplidar::kExpressType;
using rplidar::kNodeType;
using rplidar::kUltraDenseType;
using rplidar::kUltraType;

// Modes, firmware and hardware as owners' logs have them. Not published are an S1's and an S2's standard scan, and that
// the packets of an S3 are ultra-dense: somebody's must be.
constexpr std::array<RplidarMode, 5> kModesOfA1{{{"Standard", 508.0, 12.0, kNodeType},
                                                 {"Express", 254.0, 12.0, kExpressType},
                                                 {"Boost", 127.0, 12.0, kUltraType},
                                                 {"Sensitivity", 127.0, 12.0, kUltraType},
                                                 {"Stability", 201.0, 12.0, kUltraType}}};
constexpr std::array<RplidarMode, 1> kModesOfOldA1{{{"Standard", 500.0, 12.0, kNodeType}}};
constexpr std::array<RplidarMode, 2> kModesOfA1WithoutAList{
    {{"Standard", 500.0, 12.0, kNodeType}, {"Express", 250.0, 12.0, kExpressType}}};
constexpr std::array<RplidarMode, 3> kModesOfA2{
    {{"Standard", 500.0, 12.0, kNodeType}, {"Express", 250.0, 12.0, kExpressType}, {"Boost", 125.0, 12.0, kUltraType}}};
constexpr std::array<RplidarMode, 5> kModesOfA3{{{"Standard", 252.0, 25.0, kNodeType},
                                                 {"Express", 126.0, 25.0, kExpressType},
                                                 {"Boost", 63.0, 25.0, kUltraType},
                                                 {"Sensitivity", 63.0, 25.0, kUltraType},
                                                 {"Stability", 100.0, 25.0, kUltraType}}};
constexpr std::array<RplidarMode, 2> kModesOfC1{
    {{"Standard", 200.0, 16.0, kNodeType}, {"DenseBoost", 200.0, 40.0, kDenseType}}};
constexpr std::array<RplidarMode, 2> kModesOfS1{
    {{"Standard", 217.4, 40.0, kNodeType}, {"DenseBoost", 108.7, 40.0, kDenseType}}};
constexpr std::array<RplidarMode, 2> kModesOfS2{
    {{"Standard", 62.5, 30.0, kNodeType}, {"DenseBoost", 31.25, 30.0, kDenseType}}};
constexpr std::array<RplidarMode, 2> kModesOfS3{
    {{"Standard", 62.5, 40.0, kNodeType}, {"DenseBoost", 31.25, 40.0, kUltraDenseType}}};

constexpr RplidarModel kA1{.name = "rplidar-a1",
                           .product = "RPLIDAR A1",
                           .id = 0x18,
                           .firmware_minor = 29,
                           .hardware = 7,
                           .turn_ns = 181'818'182,
                           .baud = 115200,
                           .range_far_m = 12.0,
                           .range_sd_m = 0.010,
                           .rpm_min = 120,
                           .rpm_max = 600,
                           .modes = kModesOfA1,
                           .usual_mode = 3};

constexpr RplidarModel with_firmware(RplidarModel model, std::string_view name, int minor,
                                     std::span<const RplidarMode> modes) {
  model.name = name;
  model.firmware_minor = minor;
  model.modes = modes;
  return model;
}

// The first as it is sold now, then as it was before the list of modes, and before the express scan.
constexpr std::array<RplidarModel, 9> kModels{{
    kA1,
    with_firmware(kA1, "rplidar-a1-1.20", 20, kModesOfA1WithoutAList),
    with_firmware(kA1, "rplidar-a1-1.16", 16, kModesOfOldA1),
    {.name = "rplidar-a2",
     .product = "RPLIDAR A2",
     .id = 0x28,
     .firmware_minor = 24,
     .hardware = 5,
     .turn_ns = 100'000'000,
     .baud = 115200,
     .range_far_m = 16.0,
     .range_sd_m = 0.010,
     .rpm_min = 200,
     .rpm_max = 900,
     .motor_duty = 660,
     .modes = kModesOfA2,
     .usual_mode = 2},
    {.name = "rplidar-a3",
     .product = "RPLIDAR A3",
     .id = 0x31,
     .firmware_minor = 26,
     .hardware = 6,
     .turn_ns = 100'000'000,
     .baud = 256000,
     .range_far_m = 25.0,
     .range_sd_m = 0.010,
     .rpm_min = 200,
     .rpm_max = 1200,
     .motor_duty = 660,
     .modes = kModesOfA3,
     .usual_mode = 3},
    {.name = "rplidar-c1",
     .product = "RPLIDAR C1",
     .id = 0x41,
     .firmware_minor = 2,
     .hardware = 18,
     .turn_ns = 100'000'000,
     .baud = 460800,
     .range_far_m = 12.0,
     .range_sd_m = 0.015,
     .rpm_min = 480,
     .rpm_max = 720,
     .modes = kModesOfC1,
     .usual_mode = 1},
    {.name = "rplidar-s1",
     .product = "RPLIDAR S1",
     .id = 0x61,
     .firmware_minor = 2,
     .hardware = 18,
     .turn_ns = 100'000'000,
     .baud = 256000,
     .range_far_m = 40.0,
     .range_sd_m = 0.020,
     .rpm_min = 480,
     .rpm_max = 900,
     .modes = kModesOfS1,
     .usual_mode = 1},
    {.name = "rplidar-s2",
     .product = "RPLIDAR S2",
     .id = 0x71,
     .firmware_minor = 2,
     .hardware = 18,
     .turn_ns = 100'000'000,
     .baud = 1000000,
     .range_far_m = 30.0,
     .range_sd_m = 0.015,
     .rpm_min = 600,
     .rpm_max = 900,
     .modes = kModesOfS2,
     .usual_mode = 1},
    {.name = "rplidar-s3",
     .product = "RPLIDAR S3",
     .id = 0x81,
     .firmware_minor = 2,
     .hardware = 18,
     .turn_ns = 100'000'000,
     .baud = 1000000,
     .range_far_m = 40.0,
     .range_sd_m = 0.015,
     .rpm_min = 600,
     .rpm_max = 1200,
     .modes = kModesOfS3,
     .usual_mode = 1},
}};

/// Keys of settings, as Slamtec's SDK has them.
enum Key : unsigned {
  kUsualSpeed = 0x01,    ///< rpm and duty, 2 bytes each
  kScanCommands = 0x02,  ///< a bit for each mode, 4 bytes
  kSlowest = 0x04,       ///< rpm, 2 bytes
  kFastest = 0x05,
  kFarthest = 0x60,      ///< of all modes, 1/256 m
  kModes = 0x70,         ///< how many, 2 bytes
  kModeSample = 0x71,    ///< of a mode: 1/256 us, 4 bytes
  kModeFarthest = 0x74,  ///< of a mode: 1/256 m, 4 bytes
  kModeAnswer = 0x75,    ///< of a mode: type of its packets
  kUsualMode = 0x7C,
  kModeName = 0x7F,
};

void put(std::string& text, unsigned value, int bytes) {
  for (; bytes > 0; --bytes, value >>= 8U) {
    text += static_cast<char>(value & 0xFFU);
  }
}

unsigned number(std::string_view text, std::size_t at, std::size_t bytes) {
  unsigned value = 0;
  for (std::size_t i = std::min(at + bytes, text.size()); i-- > at;) {
    value = value << 8U | static_cast<unsigned char>(text[i]);
  }
  return value;
}

unsigned in_256ths(double value) { return static_cast<unsigned>(std::lround(256.0 * value)); }

void put_mode_value(std::string& answer, unsigned key, const RplidarMode& mode) {
  switch (key) {
    case kModeSample:
      return put(answer, in_256ths(mode.sample_us), 4);
    case kModeFarthest:
      return put(answer, in_256ths(mode.range_max_m), 4);
    case kModeAnswer:
      return put(answer, static_cast<unsigned>(mode.answer_type), 1);
    case kModeName:
      answer += mode.name;
      return put(answer, 0, 1);
    default:
      return;
  }
}

}  // namespace

std::span<const RplidarModel> rplidar_models() { return kModels; }

const RplidarModel* find_rplidar_model(std::string_view name) {
  const auto* const found =
      std::find_if(kModels.begin(), kModels.end(), [&](const RplidarModel& m) { return m.name == name; });
  return found == kModels.end() ? nullptr : found;
}

std::string rplidar_setting(const RplidarModel& model, std::string_view question) {
  const unsigned key = number(question, 0, 4);
  const unsigned mode = number(question, 4, 2);
  std::string answer(question.substr(0, 4));
  switch (key) {
    case kUsualSpeed:
      put(answer, static_cast<unsigned>(model.usual_rpm()), 2);
      put(answer, static_cast<unsigned>(model.motor_duty), 2);
      break;
    case kScanCommands:
      put(answer, (1U << model.modes.size()) - 1U, 4);
      break;
    case kSlowest:
      put(answer, static_cast<unsigned>(model.rpm_min), 2);
      break;
    case kFastest:
      put(answer, static_cast<unsigned>(model.rpm_max), 2);
      break;
    case kFarthest:
      put(answer, in_256ths(model.modes[model.usual_mode].range_max_m), 4);
      break;
    case kModes:
      put(answer, static_cast<unsigned>(model.modes.size()), 2);
      break;
    case kUsualMode:
      put(answer, static_cast<unsigned>(model.usual_mode), 2);
      break;
    default:
      if (mode < model.modes.size()) {
        put_mode_value(answer, key, model.modes[mode]);
      }
  }
  return answer;
}

}  // namespace odoless
