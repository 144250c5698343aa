#include "firmware/records/convert.hpp"

#include <algorithm>

namespace odoless {
namespace {

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using RowMajor5 = Eigen::Matrix<double, MotionError::kSize, MotionError::kSize, Eigen::RowMajor>;

}  // namespace

double second_peak_ratio(const MatchResult& match) {
  return match.second_peak_ratio();
}

MotionRecord to_record(const OdometryStep& step) {
  MotionRecord record;
  record.from_stamp_ns = step.from_stamp_ns;
  record.to_stamp_ns = step.to_stamp_ns;
  record.previous_T_current = step.previous_T_current;
  record.odom_T_scan = step.odom_T_scan;
  Eigen::Map<RowMajor3>(record.covariance.data()) = step.covariance;
  Eigen::Map<RowMajor5>(record.error_carried.data()) = step.error.carried;
  Eigen::Map<RowMajor5>(record.error_added.data()) = step.error.noise;
  record.information_1_m2 = {step.match.strong_information_1_m2, step.match.weak_information_1_m2};
  record.fitness = step.match.fitness;
  record.second_peak_ratio = second_peak_ratio(step.match);
  record.evaluations = step.match.evaluations;
  record.flags = (step.matched ? kMatched : 0) | (step.match.converged ? kConverged : 0) |
                 (step.match.escalated ? kEscalated : 0) |
                 (step.match.stop == StopReason::kDeadline ? kDeadlineHit : 0);
  return record;
}

OdometryStep to_step(const MotionRecord& record) {
  OdometryStep step;
  step.from_stamp_ns = record.from_stamp_ns;
  step.to_stamp_ns = record.to_stamp_ns;
  step.previous_T_current = record.previous_T_current;
  step.odom_T_scan = record.odom_T_scan;
  step.covariance = Eigen::Map<const RowMajor3>(record.covariance.data());
  step.error.carried = Eigen::Map<const RowMajor5>(record.error_carried.data());
  step.error.noise = Eigen::Map<const RowMajor5>(record.error_added.data());
  step.matched = (record.flags & kMatched) != 0;
  step.match.fitness = record.fitness;
  step.match.converged = (record.flags & kConverged) != 0;
  step.match.escalated = (record.flags & kEscalated) != 0;
  step.match.evaluations = record.evaluations;
  step.match.strong_information_1_m2 = record.information_1_m2[0];
  step.match.weak_information_1_m2 = record.information_1_m2[1];
  return step;
}

}  // namespace odoless
