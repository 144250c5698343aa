#include "tools/log/carmen_line.hpp"

#include <fmt/core.h>

#include <limits>
#include <numbers>

namespace odoless {
namespace {

constexpr double kHalfTurnRad = std::numbers::pi;
constexpr double kDegreeRad = std::numbers::pi / 180.0;
/// A SICK codes no return as 81.83 and more. Nearer codes of other lasers lie beyond the scan's range gate.
constexpr float kSickNoReturnM = 81.8F;
constexpr std::size_t kPoseFields = 6;
constexpr std::size_t kStampFields = 3;
constexpr const char* kFlaserLayout =
    "FLASER n, n ranges, 6 numbers of two poses, then ipc_timestamp host logger_timestamp (or nothing)";
constexpr const char* kRobotLaserLayout =
    "ROBOTLASER1, 7 numbers, n, n ranges, m, m remissions, 11 numbers, then ipc_timestamp host logger_timestamp";

double flaser_step_rad(std::size_t ranges) {
  switch (ranges) {
    case 180:
    case 181:
      return kDegreeRad;
    case 360:
    case 361:
      return kDegreeRad / 2.0;
    default:
      return ranges > 1 ? kHalfTurnRad / static_cast<double>(ranges - 1) : kHalfTurnRad;
  }
}

void check_numbers(const Fields& fields, std::size_t begin, std::size_t end, const char* what) {
  for (std::size_t i = begin; i < end; ++i) {
    static_cast<void>(fields.number(i, what));
  }
}

[[noreturn]] void fail_counts(const Fields& fields, std::size_t ranges, const char* layout) {
  fields.fail(fmt::format("{} fields do not fit {} ranges", fields.size(), ranges), layout);
}

/// At least 1.
std::size_t range_count(const Fields& fields, std::size_t index) {
  const std::size_t ranges = fields.count(index, Fields::kRangesMax, "the number of ranges");
  if (ranges == 0) {
    fields.fail("the message has no ranges", "at least 1");
  }
  return ranges;
}

}  // namespace

CarmenLine lay_out_flaser(const Fields& fields) {
  fields.require(2, kFlaserLayout);
  CarmenLine line{.ranges_begin = 2, .ranges = range_count(fields, 1), .no_return_m = kSickNoReturnM};
  line.laser_pose_begin = line.ranges_begin + line.ranges;
  const std::size_t poses_end = line.laser_pose_begin + kPoseFields;
  if (fields.size() == poses_end + kStampFields) {
    line.stamp = poses_end;
  } else if (fields.size() != poses_end) {
    fail_counts(fields, line.ranges, kFlaserLayout);
  }
  check_numbers(fields, line.laser_pose_begin, poses_end, "of a pose");
  line.start_angle_rad = -kHalfTurnRad / 2.0;
  line.angle_step_rad = flaser_step_rad(line.ranges);
  return line;
}

CarmenLine lay_out_robotlaser(const Fields& fields) {
  constexpr std::size_t kCountField = 8;
  constexpr std::size_t kTailNumbers = 11;
  fields.require(kCountField + 1, kRobotLaserLayout);
  CarmenLine line{.ranges_begin = kCountField + 1, .ranges = range_count(fields, kCountField)};
  const std::size_t remission_count = line.ranges_begin + line.ranges;
  if (remission_count >= fields.size()) {
    fail_counts(fields, line.ranges, kRobotLaserLayout);
  }
  line.laser_pose_begin =
      remission_count + 1 + fields.count(remission_count, Fields::kRangesMax, "the number of remissions");
  line.stamp = line.laser_pose_begin + kTailNumbers;
  if (fields.size() != *line.stamp + kStampFields) {
    fail_counts(fields, line.ranges, kRobotLaserLayout);
  }
  check_numbers(fields, 1, kCountField, "of the laser's settings");
  check_numbers(fields, line.laser_pose_begin, *line.stamp, "of the poses and the robot's state");
  line.start_angle_rad = fields.number(2, "the start angle");
  line.angle_step_rad = fields.number(4, "the angle step");
  const float range_max_m = fields.range_m(5);
  line.no_return_m = range_max_m > 0.0F ? range_max_m : std::numeric_limits<float>::infinity();
  return line;
}

}  // namespace odoless
