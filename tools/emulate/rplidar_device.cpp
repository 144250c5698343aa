#include "tools/emulate/rplidar_device.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "drivers/lrf/rplidar/packet.hpp"

namespace odoless {
namespace {

constexpr std::size_t kExpressPayload = 5;
constexpr unsigned char kExpressModeMax = 1;  ///< 0 is it for older clients, 1 by the list of modes
constexpr double kFarCompensationDeg = 7.0;
constexpr double kParallaxDegM = 1.0;

/// What the device takes off the mirror's angle for a point at that range, in its steps of an eighth of a degree: the
/// receiver sits beside the laser.
double compensation_at_deg(double range_m) {
  const double exact_deg = kFarCompensationDeg - kParallaxDegM / std::max(range_m, kParallaxDegM / kFarCompensationDeg);
  return std::round(8.0 * exact_deg) / 8.0;
}

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

unsigned quarter_mm(double range_m) { return static_cast<unsigned>(std::lround(range_m * 4000.0)); }
unsigned eighths(double angle_deg) { return static_cast<unsigned>(std::lround(angle_deg * 8.0)); }
unsigned q6(double angle_deg) { return static_cast<unsigned>(std::lround((angle_deg + 360.0) * 64.0)) % (360U * 64U); }

}  // namespace

RplidarDevice::RplidarDevice(const RplidarModel& model, EmulatedScans& source, EmulatedLrfOptions options)
    : EmulatedLrf(source, std::move(options)), model_(model) {}

void RplidarDevice::restart(std::int64_t now_ns) {
  received_.clear();
  mode_ = Mode::kIdle;
  motor_duty_ = 0;
  send(fmt::format("RP LIDAR System.\r\nFirmware Ver 1.{} - rel, HW Ver 7\r\n", model_.firmware_minor), now_ns);
}

std::int64_t RplidarDevice::sample_ns() const {
  return (mode_ == Mode::kExpress ? model_.express_sample_us : model_.sample_us) * std::int64_t{1000};
}

std::int64_t RplidarDevice::due_ns(std::int64_t piece) const {
  const std::int64_t bytes = mode_ == Mode::kExpress ? 84 : 5;  // the nodes before have been sent meanwhile
  return origin_ns() + ((piece + 1) * samples_per_piece() - 1) * sample_ns() + bytes * 10 * 1'000'000'000 / model_.baud;
}

/// The mirror's since the turn that is measured began, with its far points to the front; at any sample.
double RplidarDevice::mirror_deg(std::int64_t index) const {
  const std::int64_t start_ns = source().start_ns(turn_);
  const auto turn_ns = static_cast<double>(source().start_ns(turn_ + 1) - start_ns);
  return 360.0 * static_cast<double>(index * sample_ns() - start_ns) / turn_ns + kFarCompensationDeg;
}

void RplidarDevice::measure_turn(std::int64_t turn) {
  turn_ = turn;
  const auto first_sample_of = [&](std::int64_t start_ns) { return (start_ns + sample_ns() - 1) / sample_ns(); };
  turn_begin_ = first_sample_of(source().start_ns(turn));
  const std::int64_t end = first_sample_of(source().start_ns(turn + 1));
  const auto count = static_cast<std::size_t>(end - turn_begin_);
  beams_.resize(count);
  ranges_m_.resize(count);
  compensations_deg_.assign(count, kFarCompensationDeg);
  for (const bool is_range_known : {false, true}) {  // it tells where exactly the device says that it has looked
    for (std::size_t i = 0; i < count; ++i) {
      const std::int64_t index = turn_begin_ + static_cast<std::int64_t>(i);
      compensations_deg_[i] = is_range_known ? compensation_at_deg(ranges_m_[i]) : kFarCompensationDeg;
      beams_[i] = {-(mirror_deg(index) - compensations_deg_[i]) * std::numbers::pi / 180.0,
                   index * sample_ns() - source().start_ns(turn)};
    }
    measure(turn, beams_, ranges_m_, origin_ns() + source().start_ns(turn));
  }
}

RplidarDevice::Sample RplidarDevice::sample(std::int64_t index) {
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
  const bool turns = model_.motor_duty == 0 || motor_duty_ > 0;
  if (mode_ == Mode::kIdle || !turns) {
    return;
  }
  std::vector<Sample> samples;
  std::optional<SentScan> completed;
  for (std::int64_t i = 0; i < samples_per_piece(); ++i) {
    samples.push_back(sample(piece * samples_per_piece() + i));
    if (samples.back().completes_scan) {
      completed = SentScan{turn_ - 1, origin_ns() + source().start_ns(turn_ - 1)};
    }
  }
  const bool is_left_out = fault(FaultKind::kBeams, due_ns(piece)) && samples.front().mirror_deg > 240.0;
  if (!is_left_out) {
    send_piece(mode_ == Mode::kExpress ? capsule(samples) : nodes(samples), completed, due_ns(piece));
  }
}

std::string RplidarDevice::nodes(std::span<const Sample> samples) {
  std::string bytes;
  for (const Sample& sample : samples) {
    const unsigned distance = quarter_mm(sample.range_m);
    const unsigned quality = distance == 0 ? 0 : 15;
    bytes += byte((quality << 2U) | (sample.starts_turn ? 1U : 2U));
    put(bytes, (q6(sample.mirror_deg - sample.compensation_deg) << 1U) | 1U);
    put(bytes, distance);
  }
  return bytes;
}

std::string RplidarDevice::capsule(std::span<const Sample> samples) {
  std::string bytes;
  put(bytes, q6(samples.front().mirror_deg) | (std::exchange(is_first_capsule_, false) ? 0x8000U : 0U));
  for (std::size_t i = 0; i < samples.size(); i += 2) {
    const unsigned first = eighths(samples[i].compensation_deg);
    const unsigned second = eighths(samples[i + 1].compensation_deg);
    put(bytes, (quarter_mm(samples[i].range_m) & 0xFFFCU) | (first >> 4U));
    put(bytes, (quarter_mm(samples[i + 1].range_m) & 0xFFFCU) | (second >> 4U));
    bytes += byte((first & 0x0FU) | ((second & 0x0FU) << 4U));
  }
  const unsigned sum = xor_of(bytes);
  std::string head;
  head += byte(0xA0U | (sum & 0x0FU));
  head += byte(0x50U | (sum >> 4U));
  return head + bytes;
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

void RplidarDevice::stream(Mode mode, std::string_view answer, std::int64_t now_ns) {
  mode_ = mode;
  turn_ = -1;
  is_first_capsule_ = true;
  start_source(now_ns);
  send(std::string(answer), now_ns);
  skip_to(now_ns);
}

void RplidarDevice::execute(int command, std::string_view payload, std::int64_t now_ns) {
  using rplidar::Command;
  std::string answer;
  switch (static_cast<Command>(command)) {
    case Command::kStop:
      mode_ = Mode::kIdle;
      return;
    case Command::kReset:
      return restart(now_ns);
    case Command::kInfo:
      answer = descriptor(20, false, 0x04);
      answer += byte(static_cast<unsigned>(model_.id));
      answer += byte(static_cast<unsigned>(model_.firmware_minor));
      answer += "\x01\x07";
      answer += "ODOLESSEMULATED1";
      return send(answer, now_ns);
    case Command::kHealth:
      answer = descriptor(3, false, 0x06);
      answer.append(3, '\0');
      return send(answer, now_ns);
    case Command::kSampleTime:
      if (!model_.knows_express()) {
        return;
      }
      answer = descriptor(4, false, 0x15);
      put(answer, static_cast<unsigned>(model_.sample_us));
      put(answer, static_cast<unsigned>(model_.express_sample_us));
      return send(answer, now_ns);
    case Command::kMotor:
      motor_duty_ = payload.size() == 2
                        ? static_cast<unsigned char>(payload[0]) + 256 * static_cast<unsigned char>(payload[1])
                        : motor_duty_;
      return;
    case Command::kScan:
      return stream(Mode::kStandard, descriptor(5, true, 0x81), now_ns);
    case Command::kExpress:
      if (!model_.knows_express() || payload.size() != kExpressPayload ||
          static_cast<unsigned char>(payload[0]) > kExpressModeMax) {
        return;
      }
      return stream(Mode::kExpress, descriptor(84, true, 0x82), now_ns);
  }
  if (command == 0x21) {  // the standard scan, whatever its health
    return stream(Mode::kStandard, descriptor(5, true, 0x81), now_ns);
  }
  if (command == 0x84 && payload.size() >= 4 && model_.knows_configuration()) {
    const std::string setting = rplidar_setting(model_, payload);
    return send(descriptor(static_cast<unsigned>(setting.size()), false, 0x20) + setting, now_ns);
  }
  if (command == 0xFF) {  // whether its board has a motor that takes commands
    answer = descriptor(4, false, 0xFF);
    put(answer, model_.motor_duty > 0 ? 1U : 0U);
    put(answer, 0);
    send(answer, now_ns);
  }
}

}  // namespace odoless
