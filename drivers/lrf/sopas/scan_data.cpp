#include "drivers/lrf/sopas/scan_data.hpp"

#include <array>
#include <cmath>
#include <initializer_list>
#include <string_view>

namespace odoless::sopas {
namespace {

constexpr std::string_view kFirstEcho = "DIST1";
constexpr std::string_view kSecondEcho = "DIST2";
constexpr std::string_view kRemission = "RSSI1";
constexpr int kEncodersMax = 3;
constexpr int kChannelsMax = 8;
constexpr int kStepMaxTmdeg = 50'000;
constexpr int kFullTurnTmdeg = 3'600'000;
constexpr float kScaleMax = 100.0F;

void read_head(Fields& fields, ScanData& data) {
  data.version = static_cast<int>(fields.number(2));
  data.device_number = static_cast<int>(fields.number(2));
  data.serial_number = fields.number(4);
  static_cast<void>(fields.number(1));
  data.device_status = static_cast<int>(fields.number(1));
  data.telegram_counter = static_cast<int>(fields.number(2));
  data.scan_counter = static_cast<int>(fields.number(2));
  data.stamp_us = fields.number(4);
  data.sending_us = fields.number(4);
  for (int pin_byte = 0; pin_byte < 4; ++pin_byte) {  // inputs, outputs
    static_cast<void>(fields.number(1));
  }
  static_cast<void>(fields.number(2));  // the layer, of devices that have several
  data.scans_hz = fields.number(4) * 0.01;
  data.measurements_khz = fields.number(4) * 0.1;
  data.encoders = static_cast<int>(fields.number(2));
  for (int i = 0; i < data.encoders && i < kEncodersMax; ++i) {
    static_cast<void>(fields.number(4));
    static_cast<void>(fields.number(2));
  }
}

bool is_possible(const ScanShape& shape) {
  const std::int64_t end_tmdeg =
      shape.start_tmdeg + static_cast<std::int64_t>(shape.beams - 1) * static_cast<std::int64_t>(shape.step_tmdeg);
  return shape.beams >= 2 && shape.step_tmdeg > 0 && shape.step_tmdeg <= kStepMaxTmdeg &&
         shape.start_tmdeg >= -kFullTurnTmdeg && end_tmdeg <= kFullTurnTmdeg &&
         end_tmdeg - shape.start_tmdeg <= kFullTurnTmdeg && shape.scale > 0.0F && shape.scale <= kScaleMax &&
         std::isfinite(shape.offset);
}

void skip(Fields& fields, std::initializer_list<int> sizes_bytes) {
  for (const int bytes : sizes_bytes) {
    static_cast<void>(fields.number(bytes));
  }
}

/// What follows the ranges: each is a 1 and what it is, or a 0.
enum class TailPart { kPosition, kName, kComment, kTimeOfDay, kEvent };
constexpr std::array kTailParts{TailPart::kPosition, TailPart::kName, TailPart::kComment, TailPart::kTimeOfDay,
                                TailPart::kEvent};

/// It differs from model to model how many of them there are.
bool is_tail_whole(Fields fields) {
  for (const TailPart part : kTailParts) {
    if (fields.empty()) {
      break;
    }
    const std::uint32_t is_there = fields.number(2);
    if (is_there > 1) {
      return false;
    }
    if (is_there == 0) {
      continue;
    }
    switch (part) {
      case TailPart::kPosition:
        skip(fields, {4, 4, 4, 4, 4, 4, 1, 1});
        break;
      case TailPart::kTimeOfDay:
        skip(fields, {2, 1, 1, 1, 1, 1, 4});
        break;
      case TailPart::kEvent:
        static_cast<void>(fields.text(4));
        skip(fields, {4, 4, 4});
        break;
      case TailPart::kName:
      case TailPart::kComment:
        static_cast<void>(fields.text(fields.number(1)));
        break;
    }
  }
  return fields.ok() && fields.empty();
}

/// @return  kOk, or why the channel cannot be read.
Errc read_channel(Fields& fields, int value_bytes, ScanData& data, std::span<std::uint16_t> ranges) {
  const std::string_view content = fields.text(kFirstEcho.size());
  ScanShape shape;
  shape.scale = fields.real();
  shape.offset = fields.real();
  shape.start_tmdeg = fields.signed_number();
  shape.step_tmdeg = static_cast<int>(fields.number(2));
  shape.beams = static_cast<int>(fields.number(2));
  const bool is_first_echo = content == kFirstEcho && value_bytes == 2;
  data.has_second_echo |= content == kSecondEcho;
  data.has_remission |= content == kRemission;
  if (is_first_echo && static_cast<std::size_t>(shape.beams) > ranges.size()) {
    return Errc::kTooManyBeams;
  }
  for (int i = 0; i < shape.beams && fields.ok(); ++i) {
    const std::uint32_t value = fields.number(value_bytes);
    if (is_first_echo) {
      ranges[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(value);
    }
  }
  if (is_first_echo) {
    data.shape = shape;
    return is_possible(shape) ? Errc::kOk : Errc::kFrameMalformed;
  }
  return Errc::kOk;
}

}  // namespace

Result<ScanData> scan_data_of(const Telegram& telegram, std::span<std::uint16_t> ranges) {
  ScanData data;
  Fields fields = telegram.fields();
  read_head(fields, data);
  if (data.encoders > kEncodersMax) {
    return Errc::kFrameMalformed;
  }
  for (const int value_bytes : {2, 1}) {
    const auto channels = static_cast<int>(fields.number(2));
    if (channels > kChannelsMax) {
      return Errc::kFrameMalformed;
    }
    for (int i = 0; i < channels && fields.ok(); ++i) {
      if (const Errc error = read_channel(fields, value_bytes, data, ranges); error != Errc::kOk) {
        return error;
      }
    }
    data.channels += channels;
  }
  if (!fields.ok()) {
    return Errc::kFrameMalformed;
  }
  data.shape.has_whole_tail = is_tail_whole(fields);
  data.shape.left = static_cast<int>(fields.left());
  return data.shape.beams == 0 ? Result<ScanData>(Errc::kWrongCount) : Result<ScanData>(data);
}

}  // namespace odoless::sopas
