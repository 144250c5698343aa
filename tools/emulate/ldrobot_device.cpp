#include "tools/emulate/ldrobot_device.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "drivers/lrf/ldrobot/packet.hpp"

namespace odoless {
namespace {

constexpr std::array<LdrobotModel, 3> kModels{{
    {.name = "ld06",
     .product = "LDROBOT LD06",
     .turn_ns = 100'000'000,
     .samples_per_s = 4500,
     .baud = 230400,
     .range_far_m = 12.0,
     .range_sd_m = 0.010},
    {.name = "ld19",
     .product = "LDROBOT LD19",
     .turn_ns = 100'000'000,
     .samples_per_s = 4500,
     .baud = 230400,
     .range_far_m = 12.0,
     .range_sd_m = 0.010},
    {.name = "stl-27l",
     .product = "LDROBOT STL-27L",
     .turn_ns = 100'000'000,
     .samples_per_s = 21600,
     .baud = 921600,
     .range_far_m = 25.0,
     .range_sd_m = 0.015},
}};

constexpr auto kPoints = static_cast<std::int64_t>(ldrobot::kPacketPoints);
constexpr unsigned kStrength = 200;

EmulatedLrfOptions at_once(EmulatedLrfOptions options) {
  options.starts_at_once = true;
  return options;
}

char byte(unsigned value) { return static_cast<char>(value & 0xFFU); }
void put(std::string& text, unsigned value) {
  text += byte(value);
  text += byte(value >> 8U);
}

unsigned centidegrees(double angle_deg) {
  return static_cast<unsigned>(std::lround(std::fmod(angle_deg, 360.0) * 100.0)) % 36'000U;
}

}  // namespace

std::span<const LdrobotModel> ldrobot_models() { return kModels; }

const LdrobotModel* find_ldrobot_model(std::string_view name) {
  const auto* const found =
      std::find_if(kModels.begin(), kModels.end(), [&](const LdrobotModel& m) { return m.name == name; });
  return found == kModels.end() ? nullptr : found;
}

LdrobotDevice::LdrobotDevice(const LdrobotModel& model, EmulatedScans& source, EmulatedLrfOptions options)
    : EmulatedLrf(source, at_once(std::move(options))), model_(model) {}

double LdrobotDevice::clock_ns(std::int64_t now_ns) const {
  return clock_device_ns_ + static_cast<double>(now_ns - clock_host_ns_) * (1.0 + drift_ppm_ * 1e-6);
}

void LdrobotDevice::restart(std::int64_t now_ns) {
  clock_host_ns_ = now_ns;
  clock_device_ns_ = 0.0;
}

void LdrobotDevice::set_drift(double drift_ppm, std::int64_t now_ns) {
  clock_device_ns_ = clock_ns(now_ns);
  clock_host_ns_ = now_ns;
  drift_ppm_ = drift_ppm;
}

std::int64_t LdrobotDevice::sample_time_ns(std::int64_t index) const {
  return index * 1'000'000'000 / model_.samples_per_s;
}

std::int64_t LdrobotDevice::due_ns(std::int64_t piece) const {
  const auto bytes = static_cast<std::int64_t>(ldrobot::kPacketBytes);
  return origin_ns() + sample_time_ns((piece + 1) * kPoints - 1) + bytes * 10 * 1'000'000'000 / model_.baud;
}

std::int64_t LdrobotDevice::turn_of(std::int64_t index) const {
  std::int64_t turn = std::max<std::int64_t>(turn_, 0);
  while (turn > 0 && source().start_ns(turn) > sample_time_ns(index)) {
    --turn;
  }
  while (source().start_ns(turn + 1) <= sample_time_ns(index)) {
    ++turn;
  }
  return turn;
}

double LdrobotDevice::mirror_deg(std::int64_t index) const {
  const std::int64_t turn = turn_of(index);
  const std::int64_t start_ns = source().start_ns(turn);
  return 360.0 * static_cast<double>(sample_time_ns(index) - start_ns) /
         static_cast<double>(source().start_ns(turn + 1) - start_ns);
}

void LdrobotDevice::measure_turn(std::int64_t turn) {
  const std::int64_t start_ns = source().start_ns(turn);
  const auto first_at = [&](std::int64_t time_ns) {
    std::int64_t index = time_ns * model_.samples_per_s / 1'000'000'000;
    while (sample_time_ns(index) < time_ns) {
      ++index;
    }
    return index;
  };
  turn_ = turn;
  turn_begin_ = first_at(start_ns);
  const std::int64_t end = first_at(source().start_ns(turn + 1));
  beams_.clear();
  for (std::int64_t index = turn_begin_; index < end; ++index) {
    beams_.push_back({-mirror_deg(index) * std::numbers::pi / 180.0, sample_time_ns(index) - start_ns});
  }
  ranges_m_.resize(beams_.size());
  measure(turn, beams_, ranges_m_, origin_ns() + start_ns);
}

double LdrobotDevice::range_m(std::int64_t index) {
  if (const std::int64_t turn = turn_of(index); turn != turn_) {
    measure_turn(turn);
  }
  const double range_m = ranges_m_[static_cast<std::size_t>(index - turn_begin_)];
  return range_m < model_.range_far_m ? range_m : 0.0;
}

void LdrobotDevice::on_due(std::int64_t piece) {
  const std::int64_t first = piece * kPoints;
  const auto turn_s = static_cast<double>(model_.turn_ns) * 1e-9;
  std::string bytes = "\x54\x2C";
  put(bytes, static_cast<unsigned>(std::lround(360.0 / turn_s)));
  put(bytes, centidegrees(mirror_deg(first)));
  std::optional<SentScan> completed;
  for (std::int64_t index = first; index < first + kPoints; ++index) {
    const double seen_m = range_m(index);
    if (index == turn_begin_ && turn_ > 0) {
      completed = SentScan{turn_ - 1, origin_ns() + source().start_ns(turn_ - 1)};
    }
    put(bytes, static_cast<unsigned>(std::lround(seen_m * 1000.0)));
    bytes += byte(seen_m > 0.0 ? kStrength : 0U);
  }
  put(bytes, centidegrees(mirror_deg(first + kPoints - 1)));
  const double now_ms = clock_ns(origin_ns() + sample_time_ns(first + kPoints - 1)) * 1e-6;
  put(bytes, static_cast<unsigned>(static_cast<std::int64_t>(std::max(now_ms, 0.0)) % ldrobot::kCounterWrapMs));
  bytes += byte(ldrobot::checksum(std::as_bytes(std::span(bytes.data(), bytes.size()))));
  const bool is_left_out = fault(FaultKind::kBeams, due_ns(piece)) && mirror_deg(first) > 240.0;
  if (!is_left_out) {
    send_piece(bytes, completed, due_ns(piece));
  }
}

}  // namespace odoless
