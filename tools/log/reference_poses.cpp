#include "tools/log/reference_poses.hpp"

#include "core/math/elementary.hpp"
#include "tools/command/error.hpp"
#include "tools/log/carmen_line.hpp"
#include "tools/log/stamp.hpp"

namespace odoless {
namespace {

constexpr double kS_per_ns = 1e-9;
constexpr const char* kKnownReferences =
    "a CARMEN log with FLASER or ROBOTLASER1, or lines `stamp x y yaw` or `stamp tx ty tz qx qy qz qw`";

double stamp_s(const Fields& fields, std::size_t index) {
  return static_cast<double>(fields.stamp_ns(index)) * kS_per_ns;
}

using LayOut = CarmenLine (*)(const Fields&);

LayOut find_layout(std::string_view message) {
  if (message == "FLASER") {
    return lay_out_flaser;
  }
  return message == "ROBOTLASER1" ? lay_out_robotlaser : nullptr;
}

/// The laser's poses of a log, as read_scan_log sees its scans.
class LogPoses {
 public:
  /// False when the line is no scan of this log.
  bool add(const Fields& fields) {
    const LayOut layout = find_layout(fields.text(0));
    if (layout == nullptr || (layout_ != nullptr && layout != layout_)) {
      return false;
    }
    layout_ = layout;
    const CarmenLine line = layout(fields);
    const std::size_t at = line.laser_pose_begin;
    stamps_ns_.push_back(line.stamp ? fields.stamp_ns(*line.stamp) : 0);
    poses_.push_back({fields.number(at, "x"), fields.number(at + 1, "y"), fields.number(at + 2, "theta")});
    return true;
  }

  [[nodiscard]] bool empty() const { return poses_.empty(); }

  [[nodiscard]] ReferencePoses finish() const {
    ReferencePoses result{.is_log = true, .has_stamps = stamps_are_usable(stamps_ns_), .poses = {}};
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const double seconds = static_cast<double>(stamps_ns_[i]) * kS_per_ns;
      result.poses.push_back({result.has_stamps ? seconds : 0.0, poses_[i]});
    }
    return result;
  }

 private:
  LayOut layout_ = nullptr;
  std::vector<std::int64_t> stamps_ns_;
  std::vector<Pose2> poses_;
};

/// Yaw of a unit quaternion that turns about any axis.
double yaw_of(const Fields& fields) {
  const double x = fields.number(4, "qx");
  const double y = fields.number(5, "qy");
  const double z = fields.number(6, "qz");
  const double w = fields.number(7, "qw");
  return math::atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z);
}

ReferencePose parse_pose(const Fields& fields) {
  constexpr std::size_t kYawColumns = 4;
  constexpr std::size_t kTumColumns = 8;
  if (fields.size() != kYawColumns && fields.size() != kTumColumns) {
    fields.fail("this is no pose", kKnownReferences);
  }
  const double yaw_rad = fields.size() == kYawColumns ? fields.number(3, "yaw") : yaw_of(fields);
  return {stamp_s(fields, 0), {fields.number(1, "x"), fields.number(2, "y"), yaw_rad}};
}

bool starts_with_letter(std::string_view text) {
  const char c = text.empty() ? '#' : text.front();
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

}  // namespace

ReferencePoses read_reference_poses(const std::filesystem::path& path) {
  LineReader lines(open_bytes(path), path.string());
  return read_reference_poses(lines);
}

ReferencePoses read_reference_poses(LineReader& lines) {
  LogPoses log;
  ReferencePoses result;
  Fields fields;
  std::string_view line;
  while (lines.next(line)) {
    fields.split(line, lines);
    if (fields.size() == 0 || fields.text(0).starts_with('#')) {
      continue;
    }
    if (log.add(fields)) {
      lines.keep(2 * sizeof(ReferencePose));
      continue;
    }
    // A log has many other messages, a trajectory has numbers only.
    if (result.poses.empty() && (!log.empty() || starts_with_letter(fields.text(0)))) {
      continue;
    }
    result.poses.push_back(parse_pose(fields));
    lines.keep(sizeof(ReferencePose));
  }
  if (!log.empty()) {
    return log.finish();
  }
  if (result.poses.empty()) {
    throw DataError(lines.name(), 0, "there are no poses", kKnownReferences);
  }
  return result;
}

}  // namespace odoless
