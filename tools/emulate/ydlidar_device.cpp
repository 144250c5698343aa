#include "tools/emulate/ydlidar_device.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "drivers/lrf/ydlidar/packet.hpp"

namespace odoless {
namespace {

constexpr std::array<YdlidarModel, 4> kModels{{
    {.name = "ydlidar-x2",
     .product = "YDLIDAR X2",
     .id = 4,
     .turn_ns = 142'857'143,
     .samples_per_s = 3000,
     .baud = 115200,
     .takes_commands = false,
     .triangulates = true,
     .range_far_m = 8.0,
     .range_sd_m = 0.020},
    {.name = "ydlidar-x4",
     .product = "YDLIDAR X4",
     .id = 6,
     .turn_ns = 142'857'143,
     .samples_per_s = 5000,
     .baud = 128000,
     .takes_commands = true,
     .triangulates = true,
     .range_far_m = 10.0,
     .range_sd_m = 0.020},
    {.name = "ydlidar-g4",
     .product = "YDLIDAR G4",
     .id = 5,
     .turn_ns = 142'857'143,
     .samples_per_s = 9000,
     .baud = 230400,
     .takes_commands = true,
     .triangulates = true,
     .range_far_m = 16.0,
     .range_sd_m = 0.020},
    {.name = "ydlidar-tg30",
     .product = "YDLIDAR TG30",
     .id = 101,
     .turn_ns = 100'000'000,
     .samples_per_s = 20000,
     .baud = 512000,
     .takes_commands = true,
     .triangulates = false,
     .range_far_m = 30.0,
     .range_sd_m = 0.030},
}};

constexpr std::int64_t kPieceSamples = 40;
constexpr std::int64_t kPieceBytes = 90;
constexpr double kFarM = 1e6;
constexpr int kLooks = 4;  ///< until the direction of a point and its range agree

char byte(unsigned value) { return static_cast<char>(value & 0xFFU); }
void put(std::string& text, unsigned value) {
  text += byte(value);
  text += byte(value >> 8U);
}

unsigned angle(double angle_deg) {
  return static_cast<unsigned>(std::lround(std::fmod(angle_deg + 720.0, 360.0) * 64.0)) % (360U * 64U) << 1U | 1U;
}

std::string head(unsigned length, unsigned mode, unsigned type) {
  std::string bytes = "\xA5\x5A";
  put(bytes, length);
  put(bytes, mode << 14U);
  return bytes + byte(type);
}

}  // namespace

std::span<const YdlidarModel> ydlidar_models() { return kModels; }

const YdlidarModel* find_ydlidar_model(std::string_view name) {
  const auto* const found =
      std::find_if(kModels.begin(), kModels.end(), [&](const YdlidarModel& m) { return m.name == name; });
  return found == kModels.end() ? nullptr : found;
}

YdlidarDevice::YdlidarDevice(const YdlidarModel& model, EmulatedScans& source, EmulatedLrfOptions options)
    : EmulatedLrf(source,
                  [&] {
                    options.starts_at_once = options.starts_at_once || !model.takes_commands;
                    return std::move(options);
                  }()),
      model_(model),
      streams_(!model.takes_commands) {}

void YdlidarDevice::restart(std::int64_t now_ns) {
  received_.clear();
  streams_ = !model_.takes_commands;
  if (streams_) {
    send(information(), now_ns);
  }
}

std::string YdlidarDevice::information() const {
  std::string bytes = head(20, 0, 0x04);
  bytes += byte(static_cast<unsigned>(model_.id));
  bytes += std::string("\x00\x02\x01", 3);  // firmware, hardware
  return bytes + "2026112300000001";
}

void YdlidarDevice::hear(std::string_view bytes, std::int64_t now_ns) {
  received_ += bytes;
  while (received_.size() >= 2) {
    const bool is_command = received_[0] == '\xA5' && received_[1] != '\xA5';
    const auto command = static_cast<unsigned char>(received_[1]);
    received_.erase(0, is_command ? 2 : 1);
    if (is_command && model_.takes_commands) {
      execute(command, now_ns);
    }
  }
}

void YdlidarDevice::stream(std::int64_t now_ns) {
  streams_ = true;
  turn_ = -1;
  start_source(now_ns);
  send(head(5, 1, 0x81), now_ns);
  skip_to(now_ns);
}

void YdlidarDevice::execute(unsigned char command, std::int64_t now_ns) {
  switch (command) {
    case 0x60:
      return stream(now_ns);
    case 0x65:
      streams_ = false;
      return;
    case 0x40:
    case 0x80:
      return restart(now_ns);
    case 0x90:
      return send(information(), now_ns);
    case 0x91:
      return send(head(3, 0, 0x06) + std::string(3, '\0'), now_ns);
    default:
      return;
  }
}

std::int64_t YdlidarDevice::sample_time_ns(std::int64_t index) const {
  return index * 1'000'000'000 / model_.samples_per_s;
}

std::int64_t YdlidarDevice::due_ns(std::int64_t piece) const {
  return origin_ns() + sample_time_ns((piece + 1) * kPieceSamples - 1) + kPieceBytes * 10 * 1'000'000'000 / model_.baud;
}

/// The mirror's since the turn that is measured began, with its far points to the front.
double YdlidarDevice::mirror_deg(std::int64_t index) const {
  const std::int64_t start_ns = source().start_ns(turn_);
  const auto turn_ns = static_cast<double>(source().start_ns(turn_ + 1) - start_ns);
  const double ahead_deg = model_.triangulates ? -ydlidar::parallax_deg(kFarM) : 0.0;
  return 360.0 * static_cast<double>(sample_time_ns(index) - start_ns) / turn_ns + ahead_deg;
}

void YdlidarDevice::measure_turn(std::int64_t turn) {
  turn_ = turn;
  const auto first_at = [&](std::int64_t time_ns) {
    std::int64_t index = time_ns * model_.samples_per_s / 1'000'000'000;
    while (sample_time_ns(index) < time_ns) {
      ++index;
    }
    return index;
  };
  const std::int64_t start_ns = source().start_ns(turn);
  turn_begin_ = first_at(start_ns);
  const auto count = static_cast<std::size_t>(first_at(source().start_ns(turn + 1)) - turn_begin_);
  beams_.resize(count);
  ranges_m_.assign(count, kFarM);
  for (int look = 0; look < (model_.triangulates ? kLooks : 1); ++look) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::int64_t index = turn_begin_ + static_cast<std::int64_t>(i);
      const double ahead_deg = model_.triangulates ? ydlidar::parallax_deg(std::max(ranges_m_[i], 0.05)) : 0.0;
      beams_[i] = {-(mirror_deg(index) + ahead_deg) * std::numbers::pi / 180.0, sample_time_ns(index) - start_ns};
    }
    measure(turn, beams_, ranges_m_, origin_ns() + start_ns);
  }
}

/// Its range in the device's unit; 0: nothing answered.
unsigned YdlidarDevice::sample(std::int64_t index) {
  std::int64_t turn = std::max<std::int64_t>(turn_, 0);
  while (turn > 0 && source().start_ns(turn) > sample_time_ns(index)) {
    --turn;
  }
  while (source().start_ns(turn + 1) <= sample_time_ns(index)) {
    ++turn;
  }
  if (turn != turn_) {
    measure_turn(turn);
  }
  const double range_m = ranges_m_[static_cast<std::size_t>(index - turn_begin_)];
  const double unit_m = model_.triangulates ? 0.00025 : 0.001;
  return range_m < model_.range_far_m ? static_cast<unsigned>(std::lround(range_m / unit_m)) : 0U;
}

std::string YdlidarDevice::packet(std::int64_t first, std::span<const unsigned> samples, bool starts_turn) const {
  const auto last = first + static_cast<std::int64_t>(samples.size()) - 1;
  const double rate_hz = 1e9 / static_cast<double>(model_.turn_ns);
  std::string bytes = "\xAA\x55";
  bytes += byte(starts_turn ? static_cast<unsigned>(std::lround(10.0 * rate_hz)) << 1U | 1U : 0U);
  bytes += byte(static_cast<unsigned>(samples.size()));
  put(bytes, angle(mirror_deg(first)));
  put(bytes, angle(mirror_deg(last)));
  put(bytes, 0);
  for (const unsigned one : samples) {
    put(bytes, one);
  }
  const std::uint16_t sum = ydlidar::check_word(std::as_bytes(std::span(bytes)));
  bytes[8] = byte(sum);
  bytes[9] = byte(sum >> 8U);
  return bytes;
}

void YdlidarDevice::on_due(std::int64_t piece) {
  if (!streams_) {
    return;
  }
  const std::int64_t first = piece * kPieceSamples;
  std::string bytes;
  std::vector<unsigned> samples;
  std::optional<SentScan> completed;
  const auto pack = [&](std::int64_t end, bool starts_turn) {
    bytes += samples.empty() ? "" : packet(end - static_cast<std::int64_t>(samples.size()), samples, starts_turn);
    samples.clear();
  };
  for (std::int64_t index = first; index < first + kPieceSamples; ++index) {
    const unsigned seen = sample(index);
    if (index == turn_begin_ && turn_ > 0) {
      completed = SentScan{turn_ - 1, origin_ns() + source().start_ns(turn_ - 1)};
    }
    const bool starts_turn = std::fmod(mirror_deg(index), 360.0) < std::fmod(mirror_deg(index - 1) + 360.0, 360.0);
    if (starts_turn) {
      pack(index, false);
    }
    samples.push_back(seen);
    if (starts_turn) {
      pack(index + 1, true);
    }
  }
  pack(first + kPieceSamples, false);
  const bool is_left_out = fault(FaultKind::kBeams, due_ns(piece)) && mirror_deg(first) > 240.0;
  if (!is_left_out) {
    send_piece(bytes, completed, due_ns(piece));
  }
}

}  // namespace odoless
