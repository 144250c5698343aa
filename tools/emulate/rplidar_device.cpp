#include "tools/emulate/rplidar_device.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "drivers/lrf/arrival_clock.hpp"
#include "drivers/lrf/rplidar/packet.hpp"

namespace odoless {
namespace {

constexpr std::size_t kExpressPayload = 5;
constexpr int kLooks = 4;  ///< until the direction of a point and its range agree
constexpr std::int64_t kNodesAtOnceNs = 4'000'000;

char byte(unsigned value) { return static_cast<char>(value & 0xFFU); }
void put(std::string& text, unsigned value) {
  text += byte(value);
  text += byte(value >> 8U);
}

std::string descriptor(unsigned length, bool is_stream, unsigned type) {
  std::string bytes = "\xA5\x5A";
  put(bytes, length);
  put(bytes, is_stream ? 0x4000U : 0U);
  bytes += byte(type);
  return bytes;
}

unsigned xor_of(std::string_view bytes) {
  unsigned sum = 0;
  for (const char c : bytes) {
    sum ^= static_cast<unsigned char>(c);
  }
  return sum;
}

}  // namespace

RplidarDevice::RplidarDevice(const RplidarModel& model, EmulatedScans& source, EmulatedLrfOptions options)
    : EmulatedLrf(source, std::move(options)), model_(model), speed_rpm_(model.usual_rpm()) {}

void RplidarDevice::restart(std::int64_t now_ns) {
  received_.clear();
  mode_.reset();
  motor_duty_ = 0;
  speed_rpm_ = model_.usual_rpm();
  if (model_.triangulates()) {
    send(fmt::format("RP LIDAR System.\r\nFirmware Ver {}.{} - rel, HW Ver {}\r\n", model_.firmware_major,
                     model_.firmware_minor, model_.hardware),
         now_ns);
  }
}

bool RplidarDevice::turns() const { return model_.motor_duty > 0 ? motor_duty_ > 0 : speed_rpm_ > 0; }

std::int64_t RplidarDevice::sample_ns() const {
  return std::llround(model_.modes[mode_.value_or(0)].sample_us * 1000.0);
}

std::int64_t RplidarDevice::samples_per_piece() const {
  return format_ == nullptr ? kNodesAtOnceNs / sample_ns() : format_->points;
}

std::int64_t RplidarDevice::due_ns(std::int64_t piece) const {
  // The nodes before have been sent meanwhile.
  const std::size_t bytes = format_ == nullptr ? rplidar::kNodeBytes : format_->bytes;
  return origin_ns() + ((piece + 1) * samples_per_piece() - 1) * sample_ns() + transfer_ns(bytes, model_.baud);
}

/// What is taken off the mirror's angle for a point at that range.
double RplidarDevice::compensation_deg(double range_m) const {
  if (!model_.triangulates()) {
    return 0.0;
  }
  const double exact_deg = rplidar::compensation_deg(range_m);
  const bool is_express = format_ != nullptr && format_->type == rplidar::kExpressType;
  return is_express ? rplidar_express_compensation_deg(exact_deg) : exact_deg;
}

/// The mirror's since the turn that is measured began, with its far points to the front; at any sample.
double RplidarDevice::mirror_deg(std::int64_t index) const {
  const std::int64_t start_ns = source().start_ns(turn_);
  const auto turn_ns = static_cast<double>(source().start_ns(turn_ + 1) - start_ns);
  return 360.0 * static_cast<double>(index * sample_ns() - start_ns) / turn_ns + compensation_deg(model_.range_far_m);
}

void RplidarDevice::measure_turn(std::int64_t turn) {
  turn_ = turn;
  const auto first_sample_of = [&](std::int64_t start_ns) { return (start_ns + sample_ns() - 1) / sample_ns(); };
  turn_begin_ = first_sample_of(source().start_ns(turn));
  const std::int64_t end = first_sample_of(source().start_ns(turn + 1));
  const auto count = static_cast<std::size_t>(end - turn_begin_);
  beams_.resize(count);
  ranges_m_.resize(count);
  compensations_deg_.assign(count, compensation_deg(model_.range_far_m));
  for (int look = 0; look < (model_.triangulates() ? kLooks : 1); ++look) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::int64_t index = turn_begin_ + static_cast<std::int64_t>(i);
      compensations_deg_[i] = look > 0 ? compensation_deg(ranges_m_[i]) : compensations_deg_[i];
      beams_[i] = {-(mirror_deg(index) - compensations_deg_[i]) * std::numbers::pi / 180.0,
                   index * sample_ns() - source().start_ns(turn)};
    }
    measure(turn, beams_, ranges_m_, origin_ns() + source().start_ns(turn));
  }
}

RplidarSample RplidarDevice::sample(std::int64_t index) {
  std::int64_t turn = std::max<std::int64_t>(turn_, 0);
  while (source().start_ns(turn + 1) <= index * sample_ns()) {
    ++turn;
  }
  if (turn != turn_) {
    measure_turn(turn);
  }
  const auto i = static_cast<std::size_t>(index - turn_begin_);
  const bool has_range = ranges_m_[i] < model_.range_far_m;
  return {.mirror_deg = mirror_deg(index),
          .compensation_deg = has_range ? compensations_deg_[i] : 0.0,
          .range_m = has_range ? ranges_m_[i] : 0.0,
          .starts_turn = mirror_deg(index) >= 360.0 && mirror_deg(index - 1) < 360.0,
          .completes_scan = index == turn_begin_ && turn_ > 0};
}

void RplidarDevice::on_due(std::int64_t piece) {
  if (!mode_ || !turns()) {
    return;
  }
  const std::int64_t first = piece * samples_per_piece();
  std::vector<RplidarSample> samples;
  std::optional<SentScan> completed;
  for (std::int64_t i = 0; i < samples_per_piece(); ++i) {
    samples.push_back(sample(first + i));
    if (samples.back().completes_scan) {
      completed = SentScan{turn_ - 1, origin_ns() + source().start_ns(turn_ - 1)};
    }
  }
  const bool is_left_out = fault(FaultKind::kBeams, due_ns(piece)) && samples.front().mirror_deg > 240.0;
  std::string bytes;
  if (format_ == nullptr) {
    bytes = rplidar_nodes(samples);
  } else {
    samples.push_back(sample(first + samples_per_piece()));
    bytes = rplidar_capsule(*format_, samples, std::exchange(is_first_capsule_, false));
  }
  if (!is_left_out) {
    send_piece(bytes, completed, due_ns(piece));
  }
}

void RplidarDevice::hear(std::string_view bytes, std::int64_t now_ns) {
  received_ += bytes;
  while (take_request(now_ns)) {
  }
}

/// Whether there was a request, or what is none has been thrown away.
bool RplidarDevice::take_request(std::int64_t now_ns) {
  if (received_.empty()) {
    return false;
  }
  if (received_[0] != '\xA5') {
    received_.erase(0, 1);
    return true;
  }
  if (received_.size() < 2) {
    return false;
  }
  const auto command = static_cast<unsigned char>(received_[1]);
  if (command == 0xA5) {
    received_.erase(0, 1);
    return true;
  }
  if ((command & 0x80U) == 0) {
    received_.erase(0, 2);
    execute(command, {}, now_ns);
    return true;
  }
  if (received_.size() < 3) {
    return false;
  }
  const std::size_t summed = 3 + static_cast<std::size_t>(static_cast<unsigned char>(received_[2]));
  if (received_.size() < summed + 1) {
    return false;
  }
  const std::string request = received_.substr(0, summed + 1);
  received_.erase(0, request.size());
  if (xor_of(request) == 0) {
    execute(command, std::string_view(request).substr(3, summed - 3), now_ns);
  }
  return true;
}

void RplidarDevice::stream(std::size_t mode, std::int64_t now_ns) {
  const RplidarMode& chosen = model_.modes[mode];
  mode_ = mode;
  format_ = rplidar::find_capsule_format(chosen.answer_type);
  turn_ = -1;
  is_first_capsule_ = true;
  start_source(now_ns);
  const std::size_t bytes = format_ == nullptr ? rplidar::kNodeBytes : format_->bytes;
  send(descriptor(static_cast<unsigned>(bytes), true, static_cast<unsigned>(chosen.answer_type)), now_ns);
  skip_to(now_ns);
}

/// Its information.
std::string RplidarDevice::information() const {
  std::string answer = descriptor(20, false, 0x04);
  for (const int value : {model_.id, model_.firmware_minor, model_.firmware_major, model_.hardware}) {
    answer += byte(static_cast<unsigned>(value));
  }
  return answer + "ODOLESSEMULATED1";
}

/// What a sample takes in the standard and in the express scan.
std::string RplidarDevice::sample_times() const {
  std::string answer = descriptor(4, false, 0x15);
  for (const std::size_t mode : {0U, 1U}) {
    put(answer, static_cast<unsigned>(std::lround(model_.modes[mode].sample_us)));
  }
  return answer;
}

/// A scan in capsules, by its number in the list of modes; 0 is it for older clients.
void RplidarDevice::express(std::string_view payload, std::int64_t now_ns) {
  if (!model_.knows_express() || payload.size() != kExpressPayload) {
    return;
  }
  const std::size_t mode = std::max<std::size_t>(static_cast<unsigned char>(payload[0]), 1);
  if (mode < model_.modes.size()) {
    stream(mode, now_ns);
  }
}

void RplidarDevice::execute(int command, std::string_view payload, std::int64_t now_ns) {
  using rplidar::Command;
  const auto number = [&](int before) {
    return payload.size() == 2 ? static_cast<unsigned char>(payload[0]) + 256 * static_cast<unsigned char>(payload[1])
                               : before;
  };
  switch (static_cast<Command>(command)) {
    case Command::kStop:
      mode_.reset();
      return;
    case Command::kReset:
      return restart(now_ns);
    case Command::kInfo:
      return send(information(), now_ns);
    case Command::kHealth:
      return send(descriptor(3, false, 0x06) + std::string(3, '\0'), now_ns);
    case Command::kSampleTime:
      return model_.knows_express() ? send(sample_times(), now_ns) : void();
    case Command::kSetting:
      if (payload.size() >= 4 && model_.knows_configuration()) {
        const std::string setting = rplidar_setting(model_, payload);
        send(descriptor(static_cast<unsigned>(setting.size()), false, 0x20) + setting, now_ns);
      }
      return;
    case Command::kMotorDuty:
      motor_duty_ = number(motor_duty_);
      return;
    case Command::kMotorSpeed:
      speed_rpm_ = model_.takes_speed() ? number(speed_rpm_) : speed_rpm_;
      return;
    case Command::kScan:
      return stream(0, now_ns);
    case Command::kExpress:
      return express(payload, now_ns);
  }
  if (command == 0x21) {  // the standard scan, whatever its health
    return stream(0, now_ns);
  }
  if (command == 0xFF) {  // whether its board has a motor that takes commands
    std::string answer = descriptor(4, false, 0xFF);
    put(answer, model_.motor_duty > 0 ? 1U : 0U);
    put(answer, 0);
    send(answer, now_ns);
  }
}

}  // namespace odoless
