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
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kBacklogMax = 4;  ///< scans; a device that was held up goes on with the newest

}  // namespace

ScipDevice::ScipDevice(const ScipModel& model, ScanSource& source, ScipDeviceOptions options, std::int64_t now_ns)
    : model_(model),
      source_(source),
      options_(std::move(options)),
      rng_(options_.seed, 1),
      ranges_m_(static_cast<std::size_t>(model.beams())),
      clock_host_ns_(now_ns),
      clock_device_ns_(options_.counter_start_ms * 1e6) {
  reset_state(true);
  if (options_.starts_at_once) {
    start_source(now_ns);
  }
}

void ScipDevice::reset_state(bool is_power_up) {
  in_scip1_ = is_power_up && model_.boots_in_scip1;
  laser_on_ = false;
  in_time_mode_ = false;
  stream_.reset();
  line_.clear();
}

void ScipDevice::start_source(std::int64_t now_ns) { origin_ns_ = origin_ns_.value_or(now_ns); }

std::optional<std::int64_t> ScipDevice::source_time_ns(std::int64_t now_ns) const {
  return origin_ns_ ? std::optional(now_ns - *origin_ns_) : std::nullopt;
}

bool ScipDevice::fault(FaultKind kind, std::int64_t now_ns) const {
  return origin_ns_ && active_fault(options_.faults, kind, now_ns - *origin_ns_) != nullptr;
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

void ScipDevice::follow_faults(std::int64_t now_ns) {
  const Fault* const drift =
      origin_ns_ ? active_fault(options_.faults, FaultKind::kDrift, now_ns - *origin_ns_) : nullptr;
  if (const double drift_ppm = drift == nullptr ? 0.0 : drift->value; drift_ppm != drift_ppm_) {
    set_drift(drift_ppm, now_ns);
  }
  const bool is_rebooting = fault(FaultKind::kReboot, now_ns);
  if (is_rebooting && !was_rebooted_) {
    reset_state(true);
    clock_host_ns_ = now_ns;
    clock_device_ns_ = 0.0;
  }
  was_rebooted_ = is_rebooting;
}

std::int64_t ScipDevice::due_ns(std::int64_t index) const {
  return origin_ns_.value_or(0) + source_.start_ns(index) + model_.time_to_step_ns(model_.last_step);
}

std::int64_t ScipDevice::next_event_ns() const { return origin_ns_ ? due_ns(next_index_) : kNever; }

void ScipDevice::tick(std::int64_t now_ns) {
  follow_faults(now_ns);
  while (origin_ns_ && due_ns(next_index_) <= now_ns) {
    const bool is_stale = due_ns(next_index_ + kBacklogMax) <= now_ns;
    if (stream_ && !is_stale) {
      send_scan(next_index_);
    }
    ++next_index_;
  }
}

void ScipDevice::measure(std::int64_t index) {
  if (!fault(FaultKind::kStuck, due_ns(index))) {
    source_.measure(index, ranges_m_);
  }
}

void ScipDevice::send_scan(std::int64_t index) {
  if (skipped_ < stream_->skip) {
    ++skipped_;
    return;
  }
  skipped_ = 0;
  left_ -= stream_->count > 0 ? 1 : 0;
  const std::int64_t now_ns = due_ns(index);
  if (!fault(FaultKind::kSilence, now_ns) && !fault(FaultKind::kReboot, now_ns)) {
    SentBytes sent;
    sent.bytes = frame(*stream_, stream_->echo(left_) + '\n' + scip::summed("99"), index);
    sent.scan = {index, now_ns - model_.time_to_step_ns(model_.last_step) + model_.time_to_step_ns(model_.first_step)};
    sent.one_by_one = fault(FaultKind::kOneByte, now_ns);
    damage(sent.bytes, now_ns);
    output_.push_back(std::move(sent));
  }
  if (stream_->count > 0 && left_ == 0) {
    stream_.reset();
    laser_on_ = false;
  }
}

void ScipDevice::damage(std::string& bytes, std::int64_t now_ns) {
  if (fault(FaultKind::kTruncate, now_ns)) {
    bytes.resize(bytes.size() / 2);
  }
  if (fault(FaultKind::kWrongSum, now_ns)) {
    char& c = bytes[bytes.size() / 2];
    c = c == '0' ? '1' : '0';
  }
  if (fault(FaultKind::kGarbage, now_ns)) {
    std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<char>(rng_.below(256)); });
  }
}

std::uint32_t ScipDevice::value_mm(std::size_t first_beam, std::size_t count) const {
  const auto begin = ranges_m_.begin() + static_cast<std::ptrdiff_t>(first_beam);
  const double range_m = *std::min_element(begin, begin + static_cast<std::ptrdiff_t>(count));
  if (range_m * 1000.0 >= model_.range_far_mm) {
    return static_cast<std::uint32_t>(model_.far_code);
  }
  const long range_mm = std::lround(range_m * 1000.0);
  return static_cast<std::uint32_t>(range_mm < model_.range_min_mm ? model_.near_code : range_mm);
}

std::string ScipDevice::frame(const scip::ScanRequest& request, std::string_view head, std::int64_t index) {
  constexpr std::uint32_t kIntensity = 1000;
  measure(index);
  const std::int64_t start_ns = due_ns(index) - model_.time_to_step_ns(model_.last_step);
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
    data += scip::encoded(is_seen ? value_mm(static_cast<std::size_t>(first_beam), static_cast<std::size_t>(count)) : 0,
                          characters);
    data += request.reading == 'E' ? scip::encoded(kIntensity, characters) : "";
  }
  return std::string(head) + scip::summed(scip::encoded(counter_ms(start_ns), 4)) + scip::data_lines(data) + '\n';
}

std::vector<SentBytes> ScipDevice::take_output() { return std::exchange(output_, {}); }

void ScipDevice::receive(std::string_view bytes, std::int64_t now_ns) {
  tick(now_ns);
  if (fault(FaultKind::kSilence, now_ns) || fault(FaultKind::kReboot, now_ns)) {
    return;
  }
  for (const char c : bytes) {
    if (c != '\n' && c != '\r') {
      line_.append(line_.size() < kLineMax ? 1U : 0U, c);
    } else if (!line_.empty()) {
      execute(std::exchange(line_, {}), now_ns);
    }
  }
}

void ScipDevice::execute(const std::string& line, std::int64_t now_ns) {
  std::string bytes = reply_to(line, now_ns);
  output_.push_back({.bytes = std::move(bytes), .scan = {}, .one_by_one = fault(FaultKind::kOneByte, now_ns)});
}

}  // namespace odoless
