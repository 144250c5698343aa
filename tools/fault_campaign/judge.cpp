#include "tools/fault_campaign/judge.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace odoless::campaign {

bool is_wrong(double error_m, double error_rad) { return !(error_m <= kWrong_m && std::abs(error_rad) <= kWrong_rad); }

bool is_wrong(const Pose2& pose_T_true) { return is_wrong(pose_T_true.distance_m({}), pose_T_true.yaw_rad); }

void Calibration::add(double said, bool right) {
  const double place = std::clamp(said, 0.0, 1.0) * static_cast<double>(kBins);
  Bin& bin = bins[std::min(static_cast<std::size_t>(place), kBins - 1)];
  ++bin.poses;
  bin.right += right ? 1 : 0;
  bin.said_sum += said;
}

void Calibration::add(const Calibration& other) {
  for (std::size_t i = 0; i < kBins; ++i) {
    bins[i].poses += other.bins[i].poses;
    bins[i].right += other.bins[i].right;
    bins[i].said_sum += other.bins[i].said_sum;
  }
}

double Calibration::error() const {
  double sum = 0.0;
  for (const Bin& bin : bins) {
    sum += static_cast<double>(bin.poses) * std::abs(bin.said() - bin.share_right());
  }
  return poses() == 0 ? 0.0 : sum / static_cast<double>(poses());
}

std::int64_t Calibration::poses() const {
  return std::accumulate(bins.begin(), bins.end(), std::int64_t{0},
                         [](std::int64_t sum, const Bin& bin) { return sum + bin.poses; });
}

std::int64_t Verdict::all_scans() const { return std::accumulate(scans.begin(), scans.end(), std::int64_t{0}); }

void Judge::add(const Observation& seen) {
  const bool wrong = seen.state != HealthState::kInit && is_wrong(seen.error_m, seen.error_rad);
  watch_silence(seen, wrong);
  watch_saying(seen, wrong);
  const bool good = !wrong && seen.state == HealthState::kOk;
  recovery_.watch(seen, good, fault_end_s_, verdict_.recovered_after_s);
  settling_.watch(seen, good && seen.error_m <= kSettled_m, fault_end_s_, verdict_.settled_after_s);
  verdict_.final_error_m = seen.error_m;
  verdict_.final_error_rad = std::abs(seen.error_rad);
  if (seen.is_scan) {
    const auto state = static_cast<std::size_t>(seen.state);
    ++verdict_.scans.at(state);
    verdict_.right_scans.at(state) += wrong ? 0 : 1;
    verdict_.calibration.add(seen.confidence, !wrong);
  }
}

void Judge::watch_silence(const Observation& seen, bool wrong) {
  if (!wrong || seen.state != HealthState::kOk) {
    silent_since_s_ = kNever_s;
    return;
  }
  silent_since_s_ = std::min(silent_since_s_, seen.time_s);
  if (seen.time_s - silent_since_s_ > verdict_.silent_s) {
    verdict_.silent_s = seen.time_s - silent_since_s_;
    verdict_.silent_from_s = silent_since_s_;
  }
}

void Judge::watch_saying(const Observation& seen, bool wrong) {
  if (!wrong) {
    wrong_since_s_ = kNever_s;
    said_ = false;
    return;
  }
  wrong_since_s_ = std::min(wrong_since_s_, seen.time_s);
  if (!said_ && seen.state != HealthState::kOk) {
    said_ = true;
    verdict_.said_after_s.push_back(seen.time_s - wrong_since_s_);
  }
}

void Judge::Recovery::watch(const Observation& seen, bool good, double from_s, double& after_s) {
  constexpr double kFor_s = 2.0;
  if (seen.time_s < from_s || std::isfinite(after_s)) {
    return;
  }
  good_since_s = good ? std::min(good_since_s, seen.time_s) : kNever_s;
  if (seen.time_s - good_since_s >= kFor_s) {
    after_s = good_since_s - from_s;
  }
}

Verdict Judge::verdict() const { return verdict_; }

}  // namespace odoless::campaign
