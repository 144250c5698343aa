#include "firmware/stages/sensor_stage.hpp"

namespace odoless {
bool SensorStage::begins_anew(std::int64_t stamp_ns) {
  earlier_in_a_row_ = stamp_ns > last_earlier_ns_ ? earlier_in_a_row_ + 1 : 1;
  last_earlier_ns_ = stamp_ns;
  return earlier_in_a_row_ >= kAnewScans;
}

ScanVerdict SensorStage::judge_stamp(std::int64_t stamp_ns, std::int64_t now_ns) {
  if (stamp_ns == last_stamp_ns_) {
    ++counts_.duplicate;
    return ScanVerdict::kDuplicate;
  }
  if (stamp_ns < last_stamp_ns_ && !begins_anew(stamp_ns)) {
    ++counts_.out_of_order;
    return ScanVerdict::kOutOfOrder;
  }
  if (live_ && now_ns - stamp_ns > kLate_ns) {
    ++counts_.late;
    return ScanVerdict::kLate;
  }
  return ScanVerdict::kAccepted;
}

ScanVerdict SensorStage::process(const RawScan& raw, std::int64_t now_ns, ScanFrame& frame) {
  const ScanVerdict verdict = judge_stamp(raw.stamp_ns, now_ns);
  if (verdict != ScanVerdict::kAccepted) {
    return verdict;
  }
  if (frame.assign(raw) != Errc::kOk) {
    ++counts_.rejected;
    return ScanVerdict::kMalformed;
  }
  observe(raw, now_ns, frame);
  ++counts_.accepted;
  return ScanVerdict::kAccepted;
}

void SensorStage::observe(const RawScan& raw, std::int64_t now_ns, ScanFrame& frame) {
  if (counts_.accepted > 0 && raw.stamp_ns > last_stamp_ns_) {
    const std::int64_t period_ns = raw.stamp_ns - last_stamp_ns_;
    period_ns_ = period_ns_ == 0 ? period_ns : period_ns_ + (period_ns - period_ns_) / 8;
  }
  last_stamp_ns_ = raw.stamp_ns;
  earlier_in_a_row_ = 0;
  last_scan_ns_ = now_ns;
  frame.set_stale(stuck_.add(raw.ranges_m));
  stale_in_a_row_ = frame.is_stale() ? stale_in_a_row_ + 1 : 0;
  blind_in_a_row_ = frame.returns() < kBlindShare * frame.size() ? blind_in_a_row_ + 1 : 0;
}

}  // namespace odoless
