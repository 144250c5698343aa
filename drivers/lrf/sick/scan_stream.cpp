#include "drivers/lrf/sick/scan_stream.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace odoless::sick {
namespace {

constexpr double kRadPerCdeg = std::numbers::pi / 18000.0;
constexpr std::int64_t kBitsPerByte = 10;  ///< with start and stop bit
constexpr std::size_t kHeaderBytes = 2;
constexpr int kSlowestBaud = 9600;

double to_float_precision(double value) {
  const volatile auto rounded = static_cast<float>(value);  // volatile: see scip/scan_stream.cpp
  return static_cast<double>(rounded);
}

/// Bits of a value that are its range: 13 in the mode for 80 m, 15 in that for 32 m. What is left tells of fields.
unsigned mask_of(SickUnit unit) { return unit == SickUnit::kCm ? 0x1FFFU : 0x7FFFU; }

double metres_of(SickUnit unit) { return unit == SickUnit::kCm ? 0.01 : 0.001; }

}  // namespace

Variant variant_of(SickVariant name) {
  switch (name) {
    case SickVariant::k180By1:
      return {18000, 100};
    case SickVariant::k100By1:
      return {10000, 100};
    case SickVariant::k100ByHalf:
      return {10000, 50};
    case SickVariant::k100ByQuarter:
      return {10000, 25};
    case SickVariant::k180ByHalf:
      break;
  }
  return {18000, 50};
}

ScanStream::ScanStream(const LrfParams& params, int beams_max)
    : variant_(variant_of(params.sick_variant)), unit_(params.sick_unit), buffer_(beams_max) {}

void ScanStream::take_over(SickVariant variant, SickUnit unit) {
  variant_ = variant_of(variant);
  unit_ = unit;
}

Errc ScanStream::configure(int line_baud) {
  if (variant_.beams() > buffer_.beams_max()) {
    return Errc::kTooManyBeams;
  }
  const auto bytes = static_cast<std::int64_t>(kHeadBytes + variant_.payload_bytes() + kSumBytes);
  // An unknown line may take its time: no stall before the slowest would have carried a scan.
  const std::int64_t transfer_ns = bytes * kBitsPerByte * 1'000'000'000 / (line_baud == 0 ? kSlowestBaud : line_baud);
  const std::int64_t swept_ns = kTurnNs * variant_.field_of_view_cdeg / 36000;
  way_ns_ = (variant_.turns() - 1) * kTurnNs + swept_ns + (line_baud == 0 ? 0 : transfer_ns);
  // While a telegram is on its way, the scans that become complete are left out.
  const std::int64_t turns = std::max<std::int64_t>(variant_.turns(), (transfer_ns + kTurnNs - 1) / kTurnNs);
  geometry_ = {.beams = variant_.beams(),
               .start_angle_rad = to_float_precision(-0.5 * variant_.field_of_view_cdeg * kRadPerCdeg),
               .angle_step_rad = to_float_precision(variant_.step_cdeg * kRadPerCdeg),
               .range_min_m = 0.0,
               .range_max_m = (mask_of(unit_) - 8) * metres_of(unit_),
               .period_ns = turns * kTurnNs};
  clock_.start();
  is_first_ = true;
  buffer_.restart();
  return Errc::kOk;
}

// The eight highest values are codes: the lowest of them says that the range is more than can be told, the others tell
// of dazzling, too little signal and faults.
float ScanStream::range_m(unsigned value) const {
  const unsigned mask = mask_of(unit_);
  const unsigned range = value & mask;
  if (range >= mask - 8U) {
    return range == mask - 8U ? std::numeric_limits<float>::infinity() : 0.0F;
  }
  return static_cast<float>(range * metres_of(unit_));
}

Errc ScanStream::check_head(std::span<const std::byte> data) const {
  constexpr unsigned kCountBits = 0x03FF;
  const auto beams = static_cast<std::size_t>(variant_.beams());
  if (data.size() < kHeaderBytes + 2 * beams) {
    return Errc::kWrongCount;
  }
  const unsigned header = number(data[0], data[1]);
  if ((header & kCountBits) != beams) {
    return Errc::kWrongCount;
  }
  const bool is_part = (header & 0x2000U) != 0;
  const unsigned unit = header >> 14U;
  return is_part || unit != (unit_ == SickUnit::kMm ? 1U : 0U) ? Errc::kFrameMalformed : Errc::kOk;
}

// Scans that waited in a buffer come together; nothing tells how old they are, so their stamps are too late by that.
std::int64_t ScanStream::stamp_ns(std::int64_t arrival_ns) {
  const std::int64_t first_beam_ns = arrival_ns - way_ns_;
  if (!is_first_) {
    const std::int64_t since_ns = first_beam_ns - clock_.at_ns(turns_ * kTurnNs);
    turns_ += std::max<std::int64_t>((since_ns + kTurnNs / 2) / kTurnNs, 1);
  }
  is_first_ = false;
  const std::int64_t whole_us = clock_.host_ns(turns_ * kTurnNs, first_beam_ns) / 1000;
  last_stamp_ns_ = std::max(whole_us * 1000, last_stamp_ns_ + 1000);
  return last_stamp_ns_;
}

Result<LrfScan> ScanStream::scan(const Telegram& telegram, std::int64_t arrival_ns) {
  const std::span<const std::byte> data = telegram.data();
  if (const Errc error = check_head(data); error != Errc::kOk) {
    return error;
  }
  const std::span<float> ranges_m = buffer_.next(variant_.beams());
  for (std::size_t i = 0; i < ranges_m.size(); ++i) {
    const std::size_t at = kHeaderBytes + 2 * i;
    ranges_m[i] = range_m(number(data[at], data[at + 1]));
  }
  return LrfScan{.stamp_ns = stamp_ns(arrival_ns),
                 .arrival_ns = arrival_ns,
                 .start_angle_rad = geometry_.start_angle_rad,
                 .angle_step_rad = geometry_.angle_step_rad,
                 // Of steps below 1 degree, the beams between come with the next turns.
                 .beam_period_ns = variant_.turns() == 1 ? kTurnNs / 360 : 0,
                 .ranges_m = buffer_.seal()};
}

}  // namespace odoless::sick
