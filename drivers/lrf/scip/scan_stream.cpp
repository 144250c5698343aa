#include "drivers/lrf/scip/scan_stream.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/float_precision.hpp"

namespace odoless::scip {
namespace {

constexpr double kBitsPerByte = 10.0;  ///< with start and stop bit

/// How a reading is asked for, and what comes then.
struct Asked {
  const char* command;
  std::size_t characters_per_value;
  std::size_t values_per_beam;
  EchoChoice choice;
};

Asked asked(LrfReading reading) {
  switch (reading) {
    case LrfReading::kShortRange:
      return {"MS", 2, 1, EchoChoice::kOnly};
    case LrfReading::kRangeIntensity:
      return {"ME", 3, 2, EchoChoice::kOnly};
    case LrfReading::kLastEcho:
      return {"ND", 3, 1, EchoChoice::kLast};
    case LrfReading::kStrongestEcho:
      return {"NE", 3, 2, EchoChoice::kStrongest};
    case LrfReading::kRange:
      break;
  }
  return {"MD", 3, 1, EchoChoice::kOnly};
}

int beams_of(const Parameters& device, int cluster) {
  return (device.last_step - device.first_step + cluster) / cluster;
}

std::int64_t turn_ns(const Parameters& device) { return 60'000'000'000 / device.turns_per_minute; }

/// Time that the mirror takes from step 0.
std::int64_t time_to_step_ns(const Parameters& device, int step) {
  return turn_ns(device) * step / device.steps_per_turn;
}

/// Time on the line, with one echo a beam: lasers that tell several have a network instead of a line.
std::int64_t transfer_ns(const ScanFormat& format, int line_baud) {
  constexpr double kHeadBytes = 27.0;
  constexpr double kBytesPerCharacter = 66.0 / 64.0;  // of each line, the sum and its end
  const auto characters = static_cast<double>(format.fewest_characters());
  return line_baud == 0 ? 0
                        : std::llround((kHeadBytes + kBytesPerCharacter * characters) * kBitsPerByte / line_baud * 1e9);
}

}  // namespace

ScanFormat format_of(LrfReading reading, int beams) {
  const Asked scan = asked(reading);
  return {.echo = {},
          .characters_per_value = scan.characters_per_value,
          .values_per_beam = scan.values_per_beam,
          .beams = static_cast<std::size_t>(beams),
          .choice = scan.choice};
}

// NOLINTNEXTLINE(modernize-pass-by-value): the session and the bring-up keep their own copies
ScanStream::ScanStream(const LrfParams& params, int beams_max)
    : params_(params),
      data_(format_of(params.reading, beams_max).most_characters()),
      ranges_mm_(static_cast<std::size_t>(beams_max)),
      last_ranges_mm_(static_cast<std::size_t>(beams_max)),
      ranges_m_(static_cast<std::size_t>(beams_max)) {}

Errc ScanStream::configure(const Parameters& device, int line_baud) {
  const int beams = beams_of(device, params_.cluster);
  if (beams > static_cast<int>(ranges_m_.size())) {
    return Errc::kTooManyBeams;
  }
  format_ = format_of(params_.reading, beams);
  const std::int64_t way_ns = transfer_ns(format_, line_baud);
  const std::int64_t mirror_ns = (params_.skip + 1) * turn_ns(device);
  const double step_rad = 2.0 * std::numbers::pi / device.steps_per_turn;
  const double first_step = device.first_step + (params_.cluster - 1) / 2.0 - device.front_step;
  geometry_ = {.beams = beams,
               .start_angle_rad = to_float_precision(first_step * step_rad),
               .angle_step_rad = to_float_precision(params_.cluster * step_rad),
               .range_min_m = device.range_min_mm * 1e-3,
               .range_max_m = device.range_max_mm * 1e-3,
               .period_ns = std::max(mirror_ns, way_ns)};  // of a slow line, the device leaves scans out
  range_min_mm_ = static_cast<std::uint32_t>(device.range_min_mm);
  range_far_mm_ = std::min(static_cast<std::uint32_t>(device.range_max_mm),
                           params_.reading == LrfReading::kShortRange ? 4095U : ~0U);
  far_code_ = device.is_urg ? 0 : 1;
  write_request(device);
  format_.echo = echo();
  beam_period_ns_ = params_.cluster * turn_ns(device) / device.steps_per_turn;
  first_beam_delay_ns_ = time_to_step_ns(device, device.first_step) / 1000 * 1000;
  clock_.start(mirror_ns, time_to_step_ns(device, device.last_step) + way_ns);
  identical_run_ = 0;
  return Errc::kOk;
}

void ScanStream::write_request(const Parameters& device) {
  request_size_ = 0;
  const auto put = [&](char c) { request_[request_size_++] = c; };
  const auto put_number = [&](int number, int unit) {
    for (; unit > 0; unit /= 10) {
      put(static_cast<char>('0' + number / unit % 10));
    }
  };
  const char* const name = asked(params_.reading).command;
  put(name[0]);
  put(name[1]);
  put_number(device.first_step, 1000);
  put_number(device.last_step, 1000);
  put_number(params_.cluster, 10);
  put_number(params_.skip, 1);
  put_number(0, 10);
  put('\n');
}

float ScanStream::range_m(std::uint32_t range_mm) const {
  if (range_mm >= range_far_mm_) {
    return std::numeric_limits<float>::infinity();
  }
  if (range_mm < range_min_mm_) {
    return range_mm == far_code_ ? std::numeric_limits<float>::infinity() : 0.0F;
  }
  return static_cast<float>(range_mm * 1e-3);
}

Result<LrfScan> ScanStream::scan(const Reply& reply, std::int64_t arrival_ns) {
  const Result<RawFrame> frame = scan_of(reply, format_, {data_, ranges_mm_});
  if (!frame.ok()) {
    return frame.error();
  }
  const Result<std::int64_t> stamp_ns = clock_.host_ns(frame.value().stamp_ms, arrival_ns);
  if (!stamp_ns.ok()) {
    return stamp_ns.error();
  }
  const auto beams = static_cast<std::size_t>(geometry_.beams);
  std::transform(ranges_mm_.begin(), ranges_mm_.begin() + geometry_.beams, ranges_m_.begin(),
                 [&](std::uint32_t range_mm) { return range_m(range_mm); });
  const bool identical = std::equal(ranges_mm_.begin(), ranges_mm_.begin() + geometry_.beams, last_ranges_mm_.begin());
  identical_run_ = identical ? identical_run_ + 1 : 0;
  ranges_mm_.swap(last_ranges_mm_);
  return LrfScan{.stamp_ns = stamp_ns.value() + first_beam_delay_ns_,
                 .arrival_ns = arrival_ns,
                 .start_angle_rad = geometry_.start_angle_rad,
                 .angle_step_rad = geometry_.angle_step_rad,
                 .beam_period_ns = beam_period_ns_,
                 .ranges_m = {ranges_m_.data(), beams}};
}

}  // namespace odoless::scip
