#include "tools/c/odoless.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <new>
#include <string_view>

#include "config/config.hpp"
#include "firmware/daemon/daemon_params.hpp"
#include "firmware/records/robot_pose.hpp"
#include "firmware/stages/stage_reports.hpp"
#include "tools/replay/mapper.hpp"

struct odoless_slam {
  odoless_slam(const odoless::RobotParams& params, std::uint64_t seed)
      : mapper(params, seed), laser(odoless::LaserPlace::of(params.mount)) {}

  odoless::Mapper mapper;
  odoless::LaserPlace laser;
  odoless::ChainStep last{};  ///< of the last scan that was taken
  bool is_finished = false;
};

namespace odoless {
namespace {

constexpr std::int64_t kStampMost_ns = 4'000'000'000'000'000'000;  // any two differ by less than the type holds
constexpr double kAngleMost_rad = 100.0;

thread_local std::array<char, 4096> last_error{};  // fixed: it must be told, too, that there is no memory

odoless_status fail(odoless_status status, std::string_view sentence) {
  const std::size_t size = std::min(sentence.size(), last_error.size() - 1);
  std::copy_n(sentence.begin(), size, last_error.begin());
  last_error[size] = '\0';
  return status;
}

/// Runs a call; no exception leaves it.
template <class Call>
odoless_status guarded(const Call& call) noexcept {
  try {
    return call();
  } catch (const ConfigError& error) {
    return fail(ODOLESS_BAD_CONFIG, error.what());
  } catch (const std::bad_alloc&) {
    return fail(ODOLESS_NO_MEMORY, "not enough memory");
  } catch (const std::exception& error) {
    return fail(ODOLESS_FAILED, error.what());
  }
}

/// Whether its numbers can be reckoned with.
bool is_sane(const odoless_scan& scan) {
  return scan.stamp_ns <= kStampMost_ns && scan.stamp_ns >= -kStampMost_ns &&
         std::abs(scan.angle_min_rad) <= kAngleMost_rad && std::abs(scan.angle_step_rad) <= kAngleMost_rad;
}

odoless_pose c_pose(std::int64_t stamp_ns, const Pose2& map_T_robot) {
  return {stamp_ns, map_T_robot.x_m, map_T_robot.y_m, map_T_robot.yaw_rad};
}

odoless_state c_state(Tracking tracking) {
  switch (tracking) {
    case Tracking::kSure:
      return ODOLESS_STATE_OK;
    case Tracking::kDoubtful:
      return ODOLESS_STATE_DEGRADED;
    case Tracking::kLost:
      break;
  }
  return ODOLESS_STATE_LOST;
}

odoless_status refused(ScanVerdict verdict) {
  return fail(ODOLESS_BAD_SCAN, verdict == ScanVerdict::kDuplicate
                                    ? "this scan was taken already: the same stamp and the same ranges"
                                    : "too many beams (scan.beams_max in the configuration), or an angle step of 0");
}

}  // namespace
}  // namespace odoless

using odoless::fail;
using odoless::guarded;

const char* odoless_last_error() { return odoless::last_error.data(); }

odoless_status odoless_create(const char* config_toml, uint64_t random_seed, odoless_slam** slam) {
  return guarded([&] {
    if (slam == nullptr) {
      return fail(ODOLESS_BAD_ARGUMENT, "slam must not be null");
    }
    odoless::DaemonParams params;  // a robot's file says more than is needed here
    if (config_toml != nullptr) {
      odoless::parse_parameters(config_toml, "configuration", params);
    }
    *slam = new odoless_slam(params.robot, random_seed);  // NOLINT(cppcoreguidelines-owning-memory): the caller's
    return ODOLESS_OK;
  });
}

void odoless_destroy(odoless_slam* slam) {
  delete slam;  // NOLINT(cppcoreguidelines-owning-memory)
}

odoless_status odoless_add_scan(odoless_slam* slam, const odoless_scan* scan) {
  return guarded([&] {
    if (slam == nullptr || scan == nullptr || (scan->ranges_m == nullptr && scan->count > 0)) {
      return fail(ODOLESS_BAD_ARGUMENT, "slam, scan and its ranges_m must not be null");
    }
    if (!odoless::is_sane(*scan)) {
      return fail(ODOLESS_BAD_ARGUMENT, "stamp_ns must be within +-4e18, and angles within +-100 rad");
    }
    if (slam->is_finished) {
      return fail(ODOLESS_FINISHED, "no scan is taken after odoless_finish");
    }
    const odoless::ChainStep step = slam->mapper.process({.stamp_ns = scan->stamp_ns,
                                                          .start_angle_rad = scan->angle_min_rad,
                                                          .angle_step_rad = scan->angle_step_rad,
                                                          .ranges_m = {scan->ranges_m, scan->count}});
    if (step.verdict != odoless::ScanVerdict::kAccepted) {
      return odoless::refused(step.verdict);
    }
    slam->last = step;
    return ODOLESS_OK;
  });
}

odoless_status odoless_get_estimate(odoless_slam* slam, odoless_estimate* estimate) {
  return guarded([&] {
    if (slam == nullptr || estimate == nullptr) {
      return fail(ODOLESS_BAD_ARGUMENT, "slam and estimate must not be null");
    }
    if (slam->mapper.online_trajectory().empty()) {
      return fail(ODOLESS_NOT_YET, "no scan was taken so far");
    }
    odoless::FilterStage& filter = slam->mapper.chain().filter();
    const odoless::FilterStep& step = slam->last.filter;
    const odoless::RobotPose pose =
        robot_pose_of(pose_record_of(step, filter.filter().estimate(), filter, slam->last.stamp_ns));
    estimate->pose = odoless::c_pose(slam->last.stamp_ns, pose.map_T_robot);
    std::copy(pose.covariance.begin(), pose.covariance.end(), estimate->covariance);
    estimate->probability = step.probability;
    estimate->state = odoless::c_state(step.tracking);
    return ODOLESS_OK;
  });
}

odoless_status odoless_finish(odoless_slam* slam) {
  return guarded([&] {
    if (slam == nullptr) {
      return fail(ODOLESS_BAD_ARGUMENT, "slam must not be null");
    }
    if (!slam->is_finished) {
      slam->mapper.finish();
      slam->is_finished = true;
    }
    return ODOLESS_OK;
  });
}

odoless_status odoless_get_trajectory(odoless_slam* slam, odoless_pose* poses, size_t capacity, size_t* count) {
  return guarded([&] {
    if (slam == nullptr || count == nullptr || (poses == nullptr && capacity > 0)) {
      return fail(ODOLESS_BAD_ARGUMENT, "slam, poses and count must not be null");
    }
    *count = slam->mapper.online_trajectory().size();
    if (*count > capacity) {
      return fail(ODOLESS_TOO_SMALL, "the trajectory has more poses than the buffer has room for");
    }
    for (const odoless::StampedPose& each : slam->mapper.trajectory()) {
      *poses++ = odoless::c_pose(each.stamp_ns, slam->laser.robot_of(each.map_T_scan));
    }
    return ODOLESS_OK;
  });
}

odoless_status odoless_get_map(odoless_slam* slam, int8_t* cells, size_t capacity, odoless_grid* grid) {
  return guarded([&] {
    if (slam == nullptr || grid == nullptr || (cells == nullptr && capacity > 0)) {
      return fail(ODOLESS_BAD_ARGUMENT, "slam, cells and grid must not be null");
    }
    const odoless::OccupancyMap map = slam->mapper.map();
    *grid = {map.resolution_m, map.origin_x_m, map.origin_y_m, static_cast<size_t>(map.width_cells),
             static_cast<size_t>(map.height_cells)};
    if (map.occupancy_percent.size() > capacity) {
      return fail(ODOLESS_TOO_SMALL, "the map has more cells than the buffer has room for");
    }
    std::copy(map.occupancy_percent.begin(), map.occupancy_percent.end(), cells);
    return ODOLESS_OK;
  });
}
