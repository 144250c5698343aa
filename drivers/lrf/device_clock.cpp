#include "drivers/lrf/device_clock.hpp"

#include <algorithm>
#include <cmath>

namespace odoless {
namespace {

constexpr std::int64_t kWrapMs = 1 << 24;
constexpr std::int64_t kNsPerMs = 1'000'000;
constexpr double kResolutionS = 1e-3;
constexpr double kDriftRatioMax = 1.2e-3;
constexpr double kBucketS = 0.25;
constexpr double kSpanForDriftS = 2.0;
constexpr double kEarlyMaxS = 0.02;
constexpr int kBucketsToTrust = 4;
constexpr double kLateMaxS = 0.5;
constexpr double kSameResetS = 0.05;
constexpr int kConfirmations = 3;
constexpr int kLateConfirmations = 8;
constexpr double kTurnsRemembered = 400.0;
constexpr double kTurnsMax = 20.0;
constexpr std::int64_t kReadingHoldsNs = 2'000'000'000;  ///< then the clocks' drift would count
constexpr std::int64_t kLatencyMinNs = 1'500'000;        ///< what the whole milliseconds of two readings may be off by
constexpr std::int64_t kLatencyMaxNs = 200'000'000;      ///< more is no latency: the clock was set

/// Nearest to 0 of all numbers that differ by whole wraps.
std::int64_t wrapped(std::int64_t difference_ms) {
  const std::int64_t rest_ms = ((difference_ms % kWrapMs) + kWrapMs) % kWrapMs;
  return rest_ms >= kWrapMs / 2 ? rest_ms - kWrapMs : rest_ms;
}

std::int64_t to_ns(double seconds) { return std::llround(seconds * 1e9); }

}  // namespace

void DeviceClock::start(std::int64_t period_ns, std::int64_t delay_ns) {
  period_s_ = static_cast<double>(period_ns) * 1e-9;
  delay_ns_ = delay_ns;
  reading_.reset();
  earliest_latency_ns_ = kLatencyMaxNs;
  latency_ns_ = 0;
  fresh_ = true;
  standing_still_ = 0;
  suspects_ = 0;
}

void DeviceClock::restart(std::uint32_t device_ms, std::int64_t arrival_ns) {
  device_origin_ms_ = device_ms;
  host_origin_ns_ = arrival_ns - delay_ns_;
  last_device_ms_ = device_ms;
  last_arrival_ns_ = arrival_ns;
  offset_s_ = 0.0;
  drift_ratio_ = 0.0;
  count_ = 0;
  even_s_ = -1e9;
  turn_s_ = period_s_;
  late_in_a_row_ = 0;
  started_ = true;
}

std::int64_t DeviceClock::unwrapped_ms(std::uint32_t device_ms, std::int64_t arrival_ns) const {
  const std::int64_t expected_ms = last_device_ms_ + (arrival_ns - last_arrival_ns_) / kNsPerMs;
  return expected_ms + wrapped(static_cast<std::int64_t>(device_ms) - expected_ms);
}

DeviceClock::Sample DeviceClock::sample(std::int64_t device_ms, std::int64_t arrival_ns) const {
  const double device_s = static_cast<double>(device_ms - device_origin_ms_) * kResolutionS;
  const double host_s = static_cast<double>(arrival_ns - delay_ns_ - host_origin_ns_) * 1e-9;
  return {device_s, host_s - device_s};
}

double DeviceClock::late_s(const Sample& sample) const {
  return sample.offset_s - (offset_s_ + drift_ratio_ * sample.device_s);
}

// A scan that waited in a buffer while this process was held up is late, but its stamp follows the one before.
bool DeviceClock::plausible(const Sample& sample) const {
  const double step_s = sample.device_s - static_cast<double>(last_device_ms_ - device_origin_ms_) * kResolutionS;
  // In a new stream nothing has waited yet: a counter a little ahead of the last one's is another device's.
  const bool waited = step_s < 1.0 && !fresh_;
  const bool follows = step_s > period_s_ / 2.0 && (waited || late_s(sample) < (fresh_ ? kSameResetS : kLateMaxS));
  // At first, what came before may have been late; that it is early then is news.
  return follows && late_s(sample) > (count_ < kBucketsToTrust ? -kLateMaxS : -kEarlyMaxS);
}

// Scans from a buffer are less late one by one; those of a counter that stood still or was set back stay as late.
bool DeviceClock::stays_late(const Sample& sample) {
  const bool as_late = std::abs(sample.offset_s - late_offset_s_) < period_s_ / 4.0;
  late_in_a_row_ = late_s(sample) < kLateMaxS ? 0 : as_late ? late_in_a_row_ + 1 : 1;
  late_offset_s_ = sample.offset_s;
  return late_in_a_row_ >= kLateConfirmations;
}

bool DeviceClock::confirmed_reset(const Sample& sample) {
  const bool same = suspects_ > 0 && std::abs(sample.offset_s - suspect_offset_s_) < kSameResetS;
  suspects_ = same ? suspects_ + 1 : 1;
  suspect_offset_s_ = sample.offset_s;
  return fresh_ || suspects_ >= kConfirmations;
}

void DeviceClock::learn(const Sample& sample) {
  const auto bucket = [](const Sample& s) { return std::floor(s.device_s / kBucketS); };
  Sample& last = earliest_[static_cast<std::size_t>((first_ + count_ + kBuckets - 1) % kBuckets)];
  if (count_ > 0 && bucket(last) == bucket(sample)) {
    if (late_s(sample) < late_s(last)) {
      last = sample;
    }
    return;
  }
  first_ = count_ == kBuckets ? (first_ + 1) % kBuckets : first_;
  count_ = std::min(count_ + 1, kBuckets);
  earliest_[static_cast<std::size_t>((first_ + count_ - 1) % kBuckets)] = sample;
}

// The lower convex hull from left to right (Andrew's monotone chain); then its edge below the mean.
void DeviceClock::fit() {
  std::array<Sample, kBuckets> hull;
  int corners = 0;
  double mean_s = 0.0;
  const auto corner = [&](int i) -> Sample& { return hull[static_cast<std::size_t>(i)]; };
  for (int i = 0; i < count_; ++i) {
    const Sample& next = earliest_[static_cast<std::size_t>((first_ + i) % kBuckets)];
    mean_s += next.device_s / count_;
    const auto turns_left = [&](const Sample& a, const Sample& b) {
      return (b.device_s - a.device_s) * (next.offset_s - a.offset_s) >
             (b.offset_s - a.offset_s) * (next.device_s - a.device_s);
    };
    while (corners >= 2 && !turns_left(corner(corners - 2), corner(corners - 1))) {
      --corners;
    }
    corner(corners++) = next;
  }
  drift_ratio_ = 0.0;
  if (corner(corners - 1).device_s - corner(0).device_s > kSpanForDriftS) {
    int right = 1;
    while (corner(right).device_s < mean_s) {
      ++right;
    }
    const Sample& a = corner(right - 1);
    const Sample& b = corner(right);
    drift_ratio_ = std::clamp((b.offset_s - a.offset_s) / (b.device_s - a.device_s), -kDriftRatioMax, kDriftRatioMax);
  }
  offset_s_ = corner(0).offset_s - drift_ratio_ * corner(0).device_s;
  for (int i = 1; i < corners; ++i) {
    offset_s_ = std::min(offset_s_, corner(i).offset_s - drift_ratio_ * corner(i).device_s);
  }
}

// The mirror turns evenly, so that between the whole milliseconds of the counter lies what the turns before it predict.
// An alpha-beta filter with the gains of a line fitted to all scans so far, at most kTurnsRemembered
// [brookner1998tracking], held within the millisecond that the counter tells.
double DeviceClock::even_s(double counter_s) {
  const double middle_s = counter_s + kResolutionS / 2.0;
  const double turns = std::round((middle_s - even_s_) / turn_s_);
  if (turns < 1.0 || turns > kTurnsMax) {
    even_s_ = middle_s;
    turn_s_ = period_s_;
    turns_seen_ = 1.0;
    return even_s_;
  }
  turns_seen_ = std::min(turns_seen_ + turns, kTurnsRemembered);
  const double both = turns_seen_ * (turns_seen_ + 1.0);
  const double alpha = 2.0 * (2.0 * turns_seen_ - 1.0) / both;
  const double beta = 6.0 / both;
  const double predicted_s = even_s_ + turns * turn_s_;
  const double error_s = middle_s - predicted_s;
  even_s_ = std::clamp(predicted_s + alpha * error_s, counter_s, counter_s + kResolutionS);
  turn_s_ = std::clamp(turn_s_ + beta * error_s / turns, 0.8 * period_s_, 1.25 * period_s_);
  return even_s_;
}

std::int64_t DeviceClock::in_order(std::int64_t stamp_ns) {
  const std::int64_t whole_us = stamp_ns / 1000;
  last_stamp_ns_ = std::max(whole_us * 1000, last_stamp_ns_ + 1000);
  return last_stamp_ns_;
}

void DeviceClock::learn_latency(std::uint32_t device_ms, std::int64_t arrival_ns) {
  if (!reading_) {
    return;
  }
  const std::int64_t since_ns =
      wrapped(static_cast<std::int64_t>(device_ms) - static_cast<std::int64_t>(reading_->device_ms)) * kNsPerMs;
  const std::int64_t middle_ns = since_ns + kNsPerMs / 2;  // as the stamps have it
  const std::int64_t late_ns = arrival_ns - delay_ns_ - reading_->host_ns - middle_ns;
  if (since_ns < 0 || since_ns > kReadingHoldsNs || late_ns > kLatencyMaxNs) {
    reading_.reset();
    return;
  }
  earliest_latency_ns_ = std::min(earliest_latency_ns_, late_ns);
  latency_ns_ = earliest_latency_ns_ < kLatencyMinNs ? 0 : earliest_latency_ns_;
}

Result<std::int64_t> DeviceClock::host_ns(std::uint32_t device_ms, std::int64_t arrival_ns) {
  const bool first = !started_;
  if (!first && !fresh_ && device_ms == last_counter_ms_) {
    if (++standing_still_ < kConfirmations) {
      return Errc::kImplausibleStamp;
    }
    return in_order(arrival_ns - delay_ns_ - latency_ns_);
  }
  standing_still_ = 0;
  last_counter_ms_ = device_ms;
  if (first) {
    restart(device_ms, arrival_ns);
  }
  Sample now = sample(unwrapped_ms(device_ms, arrival_ns), arrival_ns);
  const bool plausible = first || this->plausible(now);
  if (!first && (stays_late(now) || !plausible)) {
    if (!plausible && !confirmed_reset(now)) {
      return Errc::kImplausibleStamp;
    }
    ++resets_;
    reading_.reset();
    restart(device_ms, arrival_ns);
    now = sample(device_ms, arrival_ns);
  }
  fresh_ = false;
  suspects_ = 0;
  last_device_ms_ = device_origin_ms_ + std::llround(now.device_s / kResolutionS);
  last_arrival_ns_ = arrival_ns;
  now.offset_s += now.device_s;
  now.device_s = even_s(now.device_s);
  now.offset_s -= now.device_s;
  learn(now);
  fit();
  const double host_s = now.device_s + offset_s_ + drift_ratio_ * now.device_s;
  learn_latency(device_ms, arrival_ns);
  return in_order(std::min(host_origin_ns_ + to_ns(host_s), arrival_ns - delay_ns_) - latency_ns_);
}

}  // namespace odoless
