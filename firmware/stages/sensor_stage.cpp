#include "firmware/stages/sensor_stage.hpp"

#include <bit>

namespace odoless {
namespace {

// FNV-1a over the ranges' bits: equal scans are told from noise, nothing more.
std::uint64_t digest_of(std::span<const float> ranges_m) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const float range_m : ranges_m) {
    hash = (hash ^ std::bit_cast<std::uint32_t>(range_m)) * 0x100000001b3U;
  }
  return hash;
}

}  // namespace

bool SensorStage::begins_anew(std::int64_t stamp_ns) {
  earlier_in_a_row_ = stamp_ns > last_earlier_ns_ ? earlier_in_a_row_ + 1 : 1;
  last_earlier_ns_ = stamp_ns;
  return earlier_in_a_row_ >= kAnewScans;
}

ScanVerdict SensorStage::judge(const RawScan& raw, std::uint64_t digest, std::int64_t now_ns) {
  if (raw.stamp_ns == last_stamp_ns_ && (live_ || digest == last_digest_)) {
    ++counts_.duplicate;
    return ScanVerdict::kDuplicate;
  }
  if (!live_) {
    return ScanVerdict::kAccepted;
  }
  if (raw.stamp_ns < last_stamp_ns_ && !begins_anew(raw.stamp_ns)) {
    ++counts_.out_of_order;
    return ScanVerdict::kOutOfOrder;
  }
  if (now_ns - raw.stamp_ns > kLate_ns) {
    ++counts_.late;
    return ScanVerdict::kLate;
  }
  return ScanVerdict::kAccepted;
}

ScanVerdict SensorStage::process(const RawScan& raw, std::int64_t now_ns, ScanFrame& frame) {
  const std::uint64_t digest = digest_of(raw.ranges_m);
  const ScanVerdict verdict = judge(raw, digest, now_ns);
  if (verdict != ScanVerdict::kAccepted) {
    return verdict;
  }
  if (frame.assign(mount_.apply(raw)) != Errc::kOk) {
    ++counts_.rejected;
    return ScanVerdict::kMalformed;
  }
  frame.set_time(clock_.next(raw.stamp_ns, live_ ? now_ns : ScanClock::kNoArrival));
  observe(raw, digest, now_ns, frame);
  return ScanVerdict::kAccepted;
}

void SensorStage::observe(const RawScan& raw, std::uint64_t digest, std::int64_t now_ns, ScanFrame& frame) {
  ++counts_.accepted;
  counts_.times = clock_.findings();
  counts_.out_of_order = live_ ? counts_.out_of_order : counts_.times.out_of_order;
  last_stamp_ns_ = raw.stamp_ns;
  last_digest_ = digest;
  earlier_in_a_row_ = 0;
  last_scan_ns_ = now_ns;
  stuck_.add(raw.ranges_m);
  if (stuck_.was_stuck()) {
    frame.set_unobserved_s(static_cast<double>(last_time_ns_ - seen_ns_) * 1e-9);
  }
  last_time_ns_ = frame.time_ns();
  seen_ns_ = stuck_.may_be_stuck() ? seen_ns_ : last_time_ns_;
  stuck_in_a_row_ = stuck_.is_suspect() ? stuck_in_a_row_ + 1 : 0;
  blind_in_a_row_ = frame.returns() < kBlindShare * frame.size() ? blind_in_a_row_ + 1 : 0;
}

}  // namespace odoless
