#include "tools/output/world_export.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <numbers>
#include <string>

#include "config/config.hpp"
#include "core/graph/trajectory_correction.hpp"
#include "core/graph/world_map.hpp"
#include "firmware/daemon/daemon_params.hpp"
#include "firmware/world/world_reader.hpp"
#include "tools/command/error.hpp"
#include "tools/output/g2o.hpp"
#include "tools/output/map_files.hpp"
#include "tools/output/map_picture.hpp"
#include "tools/output/result_folder.hpp"
#include "tools/output/trajectory.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

/// Of sessions, one after the other and again; to be told apart by all.
constexpr std::array<Rgb, 5> kPathColours{{{220, 50, 32}, {0, 90, 181}, {230, 159, 0}, {46, 125, 50}, {136, 34, 85}}};

/// The part of a world that a session belongs to: what loop closures join it with; and which submaps these are.
struct Joined {
  std::vector<int> submaps;
  WorldPart part;
};

Joined joined_to(const StoredWorld& world, const StoredSession& session) {
  std::vector<int> submaps = joined_submaps(world, session);
  return {submaps, part_of(world, submaps)};
}

std::size_t chosen_session(const std::filesystem::path& file, const WorldExport& asked, const StoredWorld& world) {
  const int sessions = static_cast<int>(world.sessions.size());
  if (asked.session > sessions) {
    throw UsageError(fmt::format("--session {}: there are {}", asked.session, sessions));
  }
  int chosen = asked.session;
  for (int i = 1; asked.session == 0 && i <= sessions; ++i) {
    chosen = world.sessions[static_cast<std::size_t>(i - 1)].submaps > 0 ? i : chosen;
  }
  if (chosen == 0 || world.sessions[static_cast<std::size_t>(chosen - 1)].submaps == 0) {
    throw DataError(file.string(), 0, "nothing was mapped", "a session with a submap");
  }
  return static_cast<std::size_t>(chosen - 1);
}

std::vector<StampedPose> trajectory_of(const StoredWorld& world, const StoredSession& session) {
  TrajectoryCorrection correction;
  for (int i = session.first_submap; i < session.first_submap + session.submaps; ++i) {
    const Submap& submap = world.submaps[static_cast<std::size_t>(i)];
    correction.add({submap.odom_T_submap, world.graph.pose(i), submap.origin_stamp_ns});
  }
  std::vector<StampedPose> poses = session.odometry;
  correction.survey(poses);
  correction.correct(poses);
  return poses;
}

bool is_in(const Joined& joined, const StoredSession& session) {
  return session.submaps > 0 && std::ranges::binary_search(joined.submaps, session.first_submap);
}

/// Where other sessions lie in this map is not known: they are left out, and that is said.
void tell_of_others(const StoredWorld& world, const Joined& joined, std::size_t chosen) {
  for (std::size_t i = 0; i < world.sessions.size(); ++i) {
    if (world.sessions[i].submaps > 0 && !is_in(joined, world.sessions[i])) {
      fmt::print(
          stderr,
          "odoless: session {} is left out: no loop closure joins it with session {}; `--session {}` exports it\n",
          i + 1, chosen, i + 1);
    }
  }
}

/// Turns all that lies in the world's frame, so that y is north.
void turn_north_up(PoseGraph& graph, double north_deg) {
  const Pose2 north_T_map{0.0, 0.0, wrap_angle((90.0 - north_deg) * std::numbers::pi / 180.0)};
  for (Pose2& pose : graph.poses()) {
    pose = north_T_map * pose;
  }
}

}  // namespace

std::vector<int> joined_submaps(const StoredWorld& world, const StoredSession& session) {
  return session.submaps > 0 ? connected_submaps(world.graph, session.first_submap) : std::vector<int>{};
}

RobotParams params_of(const std::filesystem::path& file, const StoredSession& session) {
  DaemonParams params;
  try {
    parse_parameters(session.about.configuration, "configuration in " + file.string(), params);
  } catch (const ConfigError& error) {
    fmt::print(stderr, "odoless: {}; the map is made with the built-in configuration\n", error.what());
  }
  return params.robot;
}

void export_world(StoredWorld& world, const std::filesystem::path& file, const WorldExport& asked) {
  if (asked.north_deg) {
    turn_north_up(world.graph, *asked.north_deg);
  }
  const std::size_t chosen = chosen_session(file, asked, world);
  const StoredSession& session = world.sessions[chosen];
  const RobotParams params = params_of(file, session);
  const Joined joined = joined_to(world, session);
  ResultFolder folder(asked.out, asked.force);
  const std::filesystem::path& out = folder.unfinished();
  std::vector<ColouredPath> paths;
  for (std::size_t i = 0; i < world.sessions.size(); ++i) {
    if (is_in(joined, world.sessions[i])) {
      const std::vector<StampedPose> poses =
          robot_trajectory(trajectory_of(world, world.sessions[i]), LaserPlace::of(params.mount));
      paths.push_back({{}, kPathColours[i % kPathColours.size()], fmt::format("path of session {}", i + 1)});
      std::ranges::transform(poses, std::back_inserter(paths.back().poses), &StampedPose::map_T_scan);
      write_trajectory(out / (i == chosen ? "trajectory.tum" : fmt::format("trajectory_{}.tum", i + 1)), poses);
    }
  }
  write_whole_file(out / "pose_graph.g2o", format_g2o(joined.part.graph));
  const LslamParams& low = params.slam.low;
  const OccupancyMap picture = render_world(joined.part.world(), low.beam, params.scan,
                                            asked.resolution_m > 0.0 ? asked.resolution_m : low.grid.resolution_m);
  if (!picture.occupancy_percent.empty()) {
    write_map(out, picture);
    const std::string title =
        fmt::format("{}, session {}{}", file.filename().string(), chosen + 1, asked.north_deg ? ", north up" : "");
    write_map_picture(out / "map.png", picture, paths, title);
    write_graph_picture(out / "pose_graph.png", picture, joined.part.graph, title + ": pose graph");
  }
  folder.finish();
  fmt::print("session {}, {} of {} submaps: {}\n", chosen + 1, joined.submaps.size(), world.submaps.size(),
             asked.out.string());
  tell_of_others(world, joined, chosen + 1);
}

}  // namespace odoless
