#include "tools/emulate/scip_device.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tools/emulate/scip_text.hpp"

namespace odoless {
namespace {

constexpr std::size_t kLineMax = 80;
constexpr double kEdgeM = 0.2;  ///< what a neighbour sees that far behind is seen by the beam too

}  // namespace

ScipDevice::ScipDevice(const ScipModel& model, EmulatedScans& source, EmulatedLrfOptions options, std::int64_t now_ns)
    : EmulatedLrf(source, options),
      model_(model),
      beams_(model.beam_list()),
      ranges_m_(beams_.size()),
      is_on_rs232_(options.rs232_baud != 0),
      baud_(is_on_rs232_ ? options.rs232_baud : 19200),
      clock_host_ns_(now_ns),
      clock_device_ns_(options.counter_start_ms * 1e6) {
  reset_state(true);
}

void ScipDevice::restart(std::int64_t now_ns) {
  reset_state(true);
  clock_host_ns_ = now_ns;
  clock_device_ns_ = 0.0;
}

void ScipDevice::reset_state(bool is_power_up) {
  in_scip1_ = is_power_up && model_.boots_in_scip1;
  laser_on_ = false;
  in_time_mode_ = false;
  stream_.reset();
  line_free_ns_ = 0;
  first_reboot_ns_.reset();
  line_.clear();
}

std::uint32_t ScipDevice::counter_ms(std::int64_t now_ns) const {
  const double since_ns = static_cast<double>(now_ns - clock_host_ns_) * (1.0 + drift_ppm_ * 1e-6);
  return static_cast<std::uint32_t>(static_cast<std::int64_t>((clock_device_ns_ + since_ns) * 1e-6) & 0xFFFFFF);
}

void ScipDevice::set_drift(double drift_ppm, std::int64_t now_ns) {
  clock_device_ns_ += static_cast<double>(now_ns - clock_host_ns_) * (1.0 + drift_ppm_ * 1e-6);
  clock_host_ns_ = now_ns;
  drift_ppm_ = drift_ppm;
}

std::int64_t ScipDevice::measured_ns(std::int64_t index) const {
  return origin_ns() + source().start_ns(index) + model_.time_to_step_ns(model_.last_step);
}

std::int64_t ScipDevice::transfer_ns() const {
  if (!is_on_rs232_ || !stream_) {
    return 0;
  }
  const int beams = (stream_->last_step - stream_->first_step + stream_->cluster) / stream_->cluster;
  const int characters = beams * (stream_->reading == 'S' ? 2 : stream_->reading == 'E' ? 6 : 3);
  const std::int64_t bytes = 27 + characters + 2 * ((characters + 63) / 64);  // echo, status, stamp; sums, line ends
  return bytes * 10 * 1'000'000'000 / baud_;
}

std::int64_t ScipDevice::due_ns(std::int64_t index) const { return measured_ns(index) + transfer_ns(); }

void ScipDevice::on_due(std::int64_t index) {
  if (stream_ && measured_ns(index) >= line_free_ns_) {
    send_scan(index);
  }
}

void ScipDevice::send_scan(std::int64_t index) {
  if (skipped_ < stream_->skip) {
    ++skipped_;
    return;
  }
  skipped_ = 0;
  line_free_ns_ = due_ns(index);
  left_ -= stream_->count > 0 ? 1 : 0;
  const std::int64_t now_ns = due_ns(index);
  const std::int64_t start_ns = measured_ns(index) - model_.time_to_step_ns(model_.last_step);
  send_piece(frame(*stream_, stream_->echo(left_) + '\n' + scip::summed("99"), index),
             SentScan{index, start_ns + model_.time_to_step_ns(model_.first_step)}, now_ns);
  if (stream_->count > 0 && left_ == 0) {
    stream_.reset();
    laser_on_ = false;
  }
}

std::uint32_t ScipDevice::value_mm(std::size_t first_beam, std::size_t count) const {
  const auto begin = ranges_m_.begin() + static_cast<std::ptrdiff_t>(first_beam);
  return code_of(*std::min_element(begin, begin + static_cast<std::ptrdiff_t>(count)));
}

std::uint32_t ScipDevice::code_of(double range_m) const {
  if (range_m * 1000.0 >= model_.range_far_mm) {
    return static_cast<std::uint32_t>(model_.far_code);
  }
  const long range_mm = std::lround(range_m * 1000.0);
  return static_cast<std::uint32_t>(range_mm < model_.range_min_mm ? model_.near_code : range_mm);
}

std::vector<std::uint32_t> ScipDevice::echoes_mm(std::size_t beam) const {
  const double near_m = ranges_m_[beam];
  const double behind_m =
      std::max(ranges_m_[beam - std::min<std::size_t>(beam, 1)], ranges_m_[std::min(beam + 1, ranges_m_.size() - 1)]);
  if (behind_m >= model_.range_far_mm / 1000.0 || behind_m - near_m < kEdgeM) {
    return {code_of(near_m)};
  }
  return {code_of(near_m), code_of(behind_m)};
}

std::string ScipDevice::frame(const scip::ScanRequest& request, std::string_view head, std::int64_t index) {
  constexpr std::uint32_t kIntensity = 1000;
  measure(index, beams_, ranges_m_, due_ns(index));
  const std::int64_t start_ns = measured_ns(index) - model_.time_to_step_ns(model_.last_step);
  const int characters = request.reading == 'S' ? 2 : 3;
  int last_step = request.last_step;
  if (fault(FaultKind::kBeams, due_ns(index))) {
    last_step -= (request.last_step - request.first_step) / 3;
  }
  std::string data;
  for (int step = request.first_step; step <= last_step; step += request.cluster) {
    const int count = std::min(request.cluster, last_step - step + 1);
    const int first_beam = step - model_.first_step;
    const bool is_seen = first_beam >= 0;  // what a client asks for before the first step is blind
    const auto beam = static_cast<std::size_t>(std::max(first_beam, 0));
    std::vector<std::uint32_t> values{is_seen ? value_mm(beam, static_cast<std::size_t>(count)) : 0};
    if (request.has_echoes && is_seen && count == 1) {
      values = echoes_mm(beam);
    }
    for (std::size_t echo = 0; echo < values.size(); ++echo) {
      data += echo == 0 ? "" : "&";
      data += scip::encoded(values[echo], characters);
      data += request.reading == 'E' ? scip::encoded(kIntensity, characters) : "";
    }
  }
  return std::string(head) + scip::summed(scip::encoded(counter_ms(start_ns), 4)) + scip::data_lines(data) + '\n';
}

void ScipDevice::hear(std::string_view bytes, std::int64_t now_ns) {
  if (now_ns < deaf_until_ns_) {
    return;
  }
  for (const char c : bytes) {
    if (c != '\n' && c != '\r') {
      line_.append(line_.size() < kLineMax ? 1U : 0U, c);
    } else if (!line_.empty() && now_ns >= deaf_until_ns_) {
      execute(std::exchange(line_, {}), now_ns);
    }
  }
}

void ScipDevice::execute(const std::string& line, std::int64_t now_ns) { send(reply_to(line, now_ns), now_ns); }

}  // namespace odoless
