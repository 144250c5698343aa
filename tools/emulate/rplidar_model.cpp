#include "tools/emulate/rplidar_model.hpp"

#include <algorithm>
#include <array>

namespace odoless {
namespace {

// The first as it is sold now, the second as it was before the express scan.
constexpr std::array<RplidarModel, 3> kModels{{
    {.name = "rplidar-a1",
     .product = "RPLIDAR A1",
     .firmware_minor = 29,
     .id = 0x18,
     .turn_ns = 181'818'182,
     .sample_us = 508,
     .express_sample_us = 254,
     .baud = 115200,
     .range_far_m = 12.0,
     .range_sd_m = 0.010,
     .rpm_min = 120,
     .rpm_max = 600,
     .motor_duty = 0},
    {.name = "rplidar-a1-1.16",
     .product = "RPLIDAR A1, firmware 1.16",
     .firmware_minor = 16,
     .id = 0x18,
     .turn_ns = 181'818'182,
     .sample_us = 500,
     .express_sample_us = 0,
     .baud = 115200,
     .range_far_m = 12.0,
     .range_sd_m = 0.010,
     .rpm_min = 0,
     .rpm_max = 0,
     .motor_duty = 0},
    {.name = "rplidar-a2",
     .product = "RPLIDAR A2",
     .firmware_minor = 29,
     .id = 0x28,
     .turn_ns = 100'000'000,
     .sample_us = 500,
     .express_sample_us = 250,
     .baud = 115200,
     .range_far_m = 16.0,
     .range_sd_m = 0.010,
     .rpm_min = 200,
     .rpm_max = 900,
     .motor_duty = 660},
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

struct Mode {
  std::string_view name;
  int RplidarModel::*sample_us;
  unsigned answer_type;
};
constexpr std::array<Mode, 2> kScanModes{
    {{"Standard", &RplidarModel::sample_us, 0x81}, {"Express", &RplidarModel::express_sample_us, 0x82}}};
constexpr unsigned kUsualScanMode = 1;

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

void put_mode_value(std::string& answer, const RplidarModel& model, unsigned key, const Mode& mode) {
  switch (key) {
    case kModeSample:
      return put(answer, 256U * static_cast<unsigned>(model.*mode.sample_us), 4);
    case kModeFarthest:
      return put(answer, static_cast<unsigned>(model.range_far_m * 256.0), 4);
    case kModeAnswer:
      return put(answer, mode.answer_type, 1);
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
      put(answer, (1U << kScanModes.size()) - 1U, 4);
      break;
    case kSlowest:
      put(answer, static_cast<unsigned>(model.rpm_min), 2);
      break;
    case kFastest:
      put(answer, static_cast<unsigned>(model.rpm_max), 2);
      break;
    case kFarthest:
      put(answer, static_cast<unsigned>(model.range_far_m * 256.0), 4);
      break;
    case kModes:
      put(answer, kScanModes.size(), 2);
      break;
    case kUsualMode:
      put(answer, kUsualScanMode, 2);
      break;
    default:
      if (mode < kScanModes.size()) {
        put_mode_value(answer, model, key, kScanModes.at(mode));
      }
  }
  return answer;
}

}  // namespace odoless
