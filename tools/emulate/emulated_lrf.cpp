#include "tools/emulate/emulated_lrf.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace odoless {
namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kStaleNs = 100'000'000;  ///< a device that was held up goes on with the newest

}  // namespace

EmulatedLrf::EmulatedLrf(EmulatedScans& source, EmulatedLrfOptions options)
    : source_(source), options_(std::move(options)), rng_(options_.seed, 1) {}

void EmulatedLrf::start_source(std::int64_t now_ns) { origin_ns_ = origin_ns_.value_or(now_ns); }

std::optional<std::int64_t> EmulatedLrf::source_time_ns(std::int64_t now_ns) const {
  return origin_ns_ ? std::optional(now_ns - *origin_ns_) : std::nullopt;
}

bool EmulatedLrf::fault(FaultKind kind, std::int64_t now_ns) const {
  return origin_ns_ && active_fault(options_.faults, kind, now_ns - *origin_ns_) != nullptr;
}

bool EmulatedLrf::is_mute(std::int64_t now_ns) const {
  return !has_power_ || fault(FaultKind::kSilence, now_ns) || fault(FaultKind::kReboot, now_ns);
}

void EmulatedLrf::set_power(bool on, std::int64_t now_ns) {
  if (on && !has_power_) {
    restart(now_ns);
  }
  has_power_ = on;
}

void EmulatedLrf::follow_faults(std::int64_t now_ns) {
  const Fault* const drift =
      origin_ns_ ? active_fault(options_.faults, FaultKind::kDrift, now_ns - *origin_ns_) : nullptr;
  if (const double drift_ppm = drift == nullptr ? 0.0 : drift->value; drift_ppm != drift_ppm_) {
    drift_ppm_ = drift_ppm;
    set_drift(drift_ppm, now_ns);
  }
  const bool is_rebooting = fault(FaultKind::kReboot, now_ns);
  if (is_rebooting && !was_rebooted_) {
    restart(now_ns);
  }
  was_rebooted_ = is_rebooting;
}

std::int64_t EmulatedLrf::next_event_ns() const {
  const std::int64_t answer_ns = later_.empty() ? kNever : later_.front().due_ns;
  return std::min(answer_ns, origin_ns_ ? due_ns(next_piece_) : kNever);
}

void EmulatedLrf::tick(std::int64_t now_ns) {
  if (options_.starts_at_once) {
    start_source(now_ns);
  }
  follow_faults(now_ns);
  for (; !later_.empty() && later_.front().due_ns <= now_ns; later_.pop_front()) {
    if (!is_mute(now_ns)) {
      send(std::move(later_.front().bytes), now_ns);
    }
  }
  while (origin_ns_ && due_ns(next_piece_) <= now_ns) {
    const bool is_stale = due_ns(next_piece_) <= now_ns - kStaleNs && due_ns(next_piece_ + 1) <= now_ns;
    if (!is_stale) {
      on_due(next_piece_);
    }
    ++next_piece_;
  }
}

void EmulatedLrf::skip_to(std::int64_t now_ns) {
  next_piece_ = 0;
  std::int64_t step = 1;
  while (due_ns(next_piece_ + step) <= now_ns) {
    step *= 2;
  }
  for (; step > 0; step /= 2) {
    next_piece_ += due_ns(next_piece_ + step - 1) <= now_ns ? step : 0;
  }
}

void EmulatedLrf::receive(std::string_view bytes, std::int64_t now_ns) {
  tick(now_ns);
  const bool understands = line_baud_ == 0 || baud() == 0 || line_baud_ == baud();
  if (!bytes.empty() && understands && !is_mute(now_ns)) {
    hear(bytes, now_ns);
  }
}

void EmulatedLrf::measure(std::int64_t index, std::span<const EmulatedBeam> beams, std::span<double> ranges_m,
                          std::int64_t now_ns) {
  if (!fault(FaultKind::kStuck, now_ns)) {
    source_.measure(index, beams, ranges_m);
  }
}

void EmulatedLrf::garble(std::string& bytes) {
  std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<char>(rng_.below(256)); });
}

void EmulatedLrf::damage(std::string& bytes, std::int64_t now_ns) {
  if (fault(FaultKind::kTruncate, now_ns)) {
    bytes.resize(bytes.size() / 2);
  }
  if (fault(FaultKind::kWrongSum, now_ns)) {
    char& c = bytes[bytes.size() / 2];
    c = c == '0' ? '1' : '0';
  }
  if (fault(FaultKind::kGarbage, now_ns)) {
    garble(bytes);
  }
}

void EmulatedLrf::send(std::string bytes, std::int64_t now_ns) {
  output_.push_back({.bytes = std::move(bytes), .scan = {}, .one_by_one = fault(FaultKind::kOneByte, now_ns)});
}

void EmulatedLrf::send_later(std::string bytes, std::int64_t due_ns) { later_.push_back({std::move(bytes), due_ns}); }

void EmulatedLrf::send_piece(std::string bytes, std::optional<SentScan> scan, std::int64_t now_ns) {
  if (is_mute(now_ns)) {
    return;
  }
  damage(bytes, now_ns);
  if (line_baud_ != 0 && baud() != 0 && line_baud_ != baud()) {
    garble(bytes);
  }
  output_.push_back({.bytes = std::move(bytes), .scan = scan, .one_by_one = fault(FaultKind::kOneByte, now_ns)});
}

std::vector<SentBytes> EmulatedLrf::take_output() { return std::exchange(output_, {}); }

}  // namespace odoless
