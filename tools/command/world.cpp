#include "tools/command/world.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "config/config.hpp"
#include "core/graph/trajectory_correction.hpp"
#include "core/graph/world_map.hpp"
#include "firmware/daemon/daemon_params.hpp"
#include "firmware/world/thinned_world.hpp"
#include "firmware/world/world_reader.hpp"
#include "tools/command/error.hpp"
#include "tools/output/g2o.hpp"
#include "tools/output/map_files.hpp"
#include "tools/output/map_picture.hpp"
#include "tools/output/progress.hpp"
#include "tools/output/result_folder.hpp"
#include "tools/output/trajectory.hpp"
#include "tools/output/whole_file.hpp"
#include "tools/output/world_merge.hpp"
#include "tools/output/world_output.hpp"

namespace odoless {
namespace {

/// Of sessions, one after the other and again; to be told apart by all.
constexpr std::array<Rgb, 5> kPathColours{{{220, 50, 32}, {0, 90, 181}, {230, 159, 0}, {46, 125, 50}, {136, 34, 85}}};

struct WorldJob {
  std::filesystem::path file;
  std::filesystem::path other;
  std::filesystem::path out;
  double resolution_m = 0.0;
  int session = 0;
  bool json = false;
  bool force = false;
};

std::unique_ptr<StoredWorld> read(const std::filesystem::path& path, WorldFile& file) {
  open_world(path, file);
  WorldReading reading = read_world(file, RobotParams{});
  if (!reading.world) {
    throw DataError(path.string(), 0, reading.wrong, "a whole world; `odoless world check` says more");
  }
  return std::move(reading.world);
}

/// The part of a world that a session belongs to: what loop closures join it with; and which submaps these are.
struct Joined {
  std::vector<int> submaps;
  WorldPart part;
};

Joined joined_to(const StoredWorld& world, const StoredSession& session) {
  std::vector<int> submaps =
      session.submaps > 0 ? connected_submaps(world.graph, session.first_submap) : std::vector<int>{};
  return {submaps, part_of(world, submaps)};
}

double travel_m(const StoredWorld& world, const StoredSession& session) {
  double sum_m = 0.0;
  for (int k = session.first_keyframe + 1; k < session.first_keyframe + session.keyframes; ++k) {
    sum_m += world.store[k].since_last.distance_m;
  }
  return sum_m;
}

/// Of where the laser was, in the map of its session.
Point2 extent_m(const StoredWorld& world, const StoredSession& session) {
  Point2 least{1e9, 1e9};
  Point2 most{-1e9, -1e9};
  for (int s = session.first_submap; s < session.first_submap + session.submaps; ++s) {
    const Submap& submap = world.submaps[static_cast<std::size_t>(s)];
    for (int k = submap.first_keyframe; k < submap.first_keyframe + submap.keyframes; ++k) {
      const Pose2 at = world.graph.pose(s) * world.store.submap_T_scan(k);
      least = {std::min(least.x_m, at.x_m), std::min(least.y_m, at.y_m)};
      most = {std::max(most.x_m, at.x_m), std::max(most.y_m, at.y_m)};
    }
  }
  return session.submaps == 0 ? Point2{} : Point2{most.x_m - least.x_m, most.y_m - least.y_m};
}

nlohmann::ordered_json session_json(const StoredWorld& world, std::size_t number) {
  const StoredSession& session = world.sessions[number];
  const Point2 extent = extent_m(world, session);
  const double duration_s =
      session.odometry.empty()
          ? 0.0
          : static_cast<double>(session.odometry.back().stamp_ns - session.odometry.front().stamp_ns) * 1e-9;
  return {{"session", number + 1},
          {"started", session.about.started},
          {"program", session.about.program},
          {"scans", session.odometry.size()},
          {"keyframes", session.keyframes},
          {"submaps", session.submaps},
          {"duration_s", duration_s},
          {"travel_m", travel_m(world, session)},
          {"extent_x_m", extent.x_m},
          {"extent_y_m", extent.y_m},
          {"joined_submaps", joined_to(world, session).submaps.size()}};
}

nlohmann::ordered_json info_of(const WorldJob& job, const StoredWorld& world) {
  const auto loops = std::ranges::count_if(world.graph.constraints(),
                                           [](const Constraint& each) { return each.is_loop && each.weight > 0.0; });
  nlohmann::ordered_json json{{"uuid", world.identity.uuid},
                              {"revision", world.identity.revision},
                              {"created", world.identity.created},
                              {"program", world.identity.program},
                              {"size_bytes", std::filesystem::file_size(job.file)},
                              {"keyframes", world.store.size()},
                              {"submaps", world.submaps.size()},
                              {"loop_closures", loops},
                              {"sessions", nlohmann::ordered_json::array()}};
  for (std::size_t number = 0; number < world.sessions.size(); ++number) {
    json["sessions"].push_back(session_json(world, number));
  }
  return json;
}

void run_info(const WorldJob& job) {
  WorldFile file;
  const nlohmann::ordered_json info = info_of(job, *read(job.file, file));
  if (job.json) {
    fmt::print("{}\n", info.dump(2));
    return;
  }
  const auto text = [](const nlohmann::ordered_json& of, const char* key) { return of[key].get<std::string>(); };
  fmt::print("world     {}, revision {}, made {} by odoless {}\n", text(info, "uuid"), info["revision"].get<int>(),
             text(info, "created"), text(info, "program"));
  fmt::print("size      {:.2f} MB: {} keyframes, {} submaps, {} loop closures\n",
             info["size_bytes"].get<double>() * 1e-6, info["keyframes"].get<int>(), info["submaps"].get<int>(),
             info["loop_closures"].get<int>());
  for (const nlohmann::ordered_json& each : info["sessions"]) {
    fmt::print(
        "session {} started {} by odoless {}: {} scans in {:.1f} s, {} keyframes in {} submaps; {:.1f} m of "
        "travel within {:.1f} m by {:.1f} m; its map has {} submaps\n",
        each["session"].get<int>(), text(each, "started"), text(each, "program"), each["scans"].get<int>(),
        each["duration_s"].get<double>(), each["keyframes"].get<int>(), each["submaps"].get<int>(),
        each["travel_m"].get<double>(), each["extent_x_m"].get<double>(), each["extent_y_m"].get<double>(),
        each["joined_submaps"].get<int>());
  }
}

void run_check(const WorldJob& job) {
  WorldFile file;
  const std::unique_ptr<StoredWorld> world = read(job.file, file);
  if (const std::string damage = file.damage(); !damage.empty()) {
    throw DataError(job.file.string(), 0, "damaged: " + damage, "a whole world");
  }
  fmt::print("{}: whole: {} keyframes, {} submaps, {} constraints in {} sessions\n", job.file.string(),
             world->store.size(), world->submaps.size(), world->graph.constraints().size(), world->sessions.size());
}

/// What a session was run with; what this program does not know of it is said, and is then as built in.
RobotParams params_of(const std::filesystem::path& file, const StoredSession& session) {
  DaemonParams params;
  try {
    parse_parameters(session.about.configuration, "configuration in " + file.string(), params);
  } catch (const ConfigError& error) {
    fmt::print(stderr, "odoless: {}; the map is made with the built-in configuration\n", error.what());
  }
  return params.robot;
}

std::size_t chosen_session(const WorldJob& job, const StoredWorld& world) {
  const int sessions = static_cast<int>(world.sessions.size());
  if (job.session > sessions) {
    throw UsageError(fmt::format("--session {}: there are {}", job.session, sessions));
  }
  int chosen = job.session;
  for (int i = 1; job.session == 0 && i <= sessions; ++i) {
    chosen = world.sessions[static_cast<std::size_t>(i - 1)].submaps > 0 ? i : chosen;
  }
  if (chosen == 0 || world.sessions[static_cast<std::size_t>(chosen - 1)].submaps == 0) {
    throw DataError(job.file.string(), 0, "nothing was mapped", "a session with a submap");
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

void run_export(const WorldJob& job) {
  WorldFile file;
  const std::unique_ptr<StoredWorld> world = read(job.file, file);
  const std::size_t chosen = chosen_session(job, *world);
  const StoredSession& session = world->sessions[chosen];
  const RobotParams params = params_of(job.file, session);
  const Joined joined = joined_to(*world, session);
  ResultFolder folder(job.out, job.force);
  const std::filesystem::path& out = folder.unfinished();
  std::vector<ColouredPath> paths;
  for (std::size_t i = 0; i < world->sessions.size(); ++i) {
    if (is_in(joined, world->sessions[i])) {
      const std::vector<StampedPose> poses =
          robot_trajectory(trajectory_of(*world, world->sessions[i]), LaserPlace::of(params.mount));
      paths.push_back({{}, kPathColours[i % kPathColours.size()], fmt::format("path of session {}", i + 1)});
      std::ranges::transform(poses, std::back_inserter(paths.back().poses), &StampedPose::map_T_scan);
      write_trajectory(out / (i == chosen ? "trajectory.tum" : fmt::format("trajectory_{}.tum", i + 1)), poses);
    }
  }
  write_whole_file(out / "pose_graph.g2o", format_g2o(joined.part.graph));
  const LslamParams& low = params.slam.low;
  const OccupancyMap picture = render_world(joined.part.world(), low.beam, params.scan,
                                            job.resolution_m > 0.0 ? job.resolution_m : low.grid.resolution_m);
  if (!picture.occupancy_percent.empty()) {
    write_map(out, picture);
    const std::string title = fmt::format("{}, session {}", job.file.filename().string(), chosen + 1);
    write_map_picture(out / "map.png", picture, paths, title);
    write_graph_picture(out / "pose_graph.png", picture, joined.part.graph, title + ": pose graph");
  }
  folder.finish();
  fmt::print("session {}, {} of {} submaps: {}\n", chosen + 1, joined.submaps.size(), world->submaps.size(),
             job.out.string());
  tell_of_others(*world, joined, chosen + 1);
}

void run_compact(const WorldJob& job) {
  WorldFile file;
  open_world(job.file, file);  // before anything is made
  file.close();
  const auto before = std::filesystem::file_size(job.file);
  FileFailure failed = file.open_to_write(job.file, "");
  if (!failed.any()) {
    failed = file.compact();
  }
  if (failed.any()) {
    throw IoError(fmt::format("{}: {}; it is as it was", job.file.string(), failed.text));
  }
  fmt::print("{}: {} bytes, before {}\n", job.file.string(), std::filesystem::file_size(job.file), before);
}

void run_thin(const WorldJob& job) {
  WorldFile file;
  open_world(job.file, file);  // before anything is made
  file.close();
  FileFailure failed = file.open_to_write(job.file, "");
  WorldReading reading = failed.any() ? WorldReading{} : read_world(file, RobotParams{});
  if (!failed.any() && !reading.world) {
    throw DataError(job.file.string(), 0, reading.wrong, "a whole world; `odoless world check` says more");
  }
  int submaps = 0;
  int left = 0;
  if (!failed.any()) {
    const std::unique_ptr<StoredWorld> thin = thinned(*reading.world);
    submaps = reading.world->graph.size();
    left = thin ? thin->graph.size() : submaps;
    failed = thin ? leave_out(file, *reading.world, *thin) : FileFailure{};
  }
  if (!failed.any()) {
    failed = file.compact();
  }
  if (failed.any()) {
    throw IoError(fmt::format("{}: {}; nothing of the map was left out", job.file.string(), failed.text));
  }
  fmt::print("{}: {} of {} submaps are left, {} bytes\n", job.file.string(), left, submaps,
             std::filesystem::file_size(job.file));
}

bool has_session(const StoredWorld& world, const StoredSession& session) {
  return std::ranges::any_of(world.sessions, [&](const StoredSession& each) {
    return each.about.started == session.about.started && each.about.seed == session.about.seed &&
           each.keyframes == session.keyframes;
  });
}

/// Those of the other world that this one lacks.
std::vector<SessionToMerge> sessions_to_merge(const WorldJob& job, const StoredWorld& world, const StoredWorld& other) {
  std::vector<SessionToMerge> sessions;
  for (std::size_t i = 0; i < other.sessions.size(); ++i) {
    const StoredSession& session = other.sessions[i];
    if (session.submaps > 0 && !has_session(world, session)) {
      sessions.push_back({i, params_of(job.other, session)});
    }
  }
  if (sessions.empty()) {
    throw DataError(job.other.string(), 0, "has no session with a submap that " + job.file.string() + " lacks",
                    "a world with other sessions");
  }
  return sessions;
}

std::string line_of(const MergedSession& merged) {
  const std::string what = merged.is_joined ? fmt::format("joined, {} loop closures", merged.closures)
                           : merged.closures > 0
                               ? fmt::format("left out, for it takes {} loop closures to be sure, and it has {}",
                                             kClosures_min, merged.closures)
                               : "left out, for no place is surely where it was";
  return fmt::format("session {} of {} submaps: {}", merged.number + 1, merged.submaps, what);
}

void refuse_if_there(const std::filesystem::path& out) {
  for (const char* const beside : {"", "-wal"}) {  // SQLite would take what is left of an earlier file into the new one
    if (const std::filesystem::path path = out.string() + beside; std::filesystem::exists(path)) {
      throw CannotCreateError(path.string() + ": is there already, and is not replaced: another name is needed");
    }
  }
}

void run_merge(const WorldJob& job) {
  refuse_if_there(job.out);
  WorldFile file;
  const std::unique_ptr<StoredWorld> world = read(job.file, file);
  WorldFile other_file;
  const std::unique_ptr<StoredWorld> other = read(job.other, other_file);
  if (world->submaps.empty()) {
    throw DataError(job.file.string(), 0, "nothing was mapped", "a world with a submap");
  }
  const std::vector<SessionToMerge> sessions = sessions_to_merge(job, *world, *other);
  std::int64_t keyframes = 0;
  for (const SessionToMerge& each : sessions) {
    keyframes += other->sessions[each.number].keyframes;
  }
  std::vector<MergedSession> merged;
  {
    Progress bar(keyframes, InPipe::kLines);
    merged = merge_sessions(file, *other, sessions, job.out, [&](std::int64_t done) { bar.update(done, {}); });
  }
  for (const MergedSession& each : merged) {
    fmt::print(each.is_joined ? stdout : stderr, "{}\n", line_of(each));
  }
  if (std::ranges::none_of(merged, &MergedSession::is_joined)) {
    throw DataError(job.other.string(), 0, "is not merged: it may be of another building than " + job.file.string(),
                    "a world that shares ten metres of way or more with it");
  }
  fmt::print("{}\n", job.out.string());
}

CLI::App* add_job(CLI::App& world, const char* name, const char* what, WorldJob& job) {
  CLI::App* const command = world.add_subcommand(name, what);
  command->add_option("FILE", job.file, "World file")->required();
  return command;
}

}  // namespace

void add_world(CLI::App& app) {
  CLI::App* const world = app.add_subcommand("world", "World files: maps that last");
  world->require_subcommand(1);
  const auto job = std::make_shared<WorldJob>();
  CLI::App* const info = add_job(*world, "info", "Say what a world holds", *job);
  info->add_flag("--json", job->json, "Write one JSON object instead of text");
  info->callback([job] { run_info(*job); });
  add_job(*world, "check", "Check a world; exit with 65 where something is wrong", *job)->callback([job] {
    run_check(*job);
  });
  CLI::App* const output = add_job(*world, "export", "Write map, trajectories and pose graph, with pictures", *job);
  output->add_option("--out", job->out, "Folder for the results")->required();
  output->add_flag("--force", job->force, "Replace the results that are in the folder");
  output->add_option("--resolution", job->resolution_m, "Side of a map cell in metres; 0: as configured")
      ->check(CLI::Range(0.0, 10.0));
  output->add_option("--session", job->session, "Session, with those that loop closures join it with; 0: the last one")
      ->check(CLI::Range(0, 1000000));
  output->callback([job] { run_export(*job); });
  CLI::App* const merge = add_job(*world, "merge", "Join two worlds of one building in a new file", *job);
  merge->add_option("OTHER", job->other, "World file whose sessions are to be found in the first")->required();
  merge->add_option("--out", job->out, "New world file for both")->required();
  merge->callback([job] { run_merge(*job); });
  add_job(*world, "thin", "Leave out of a world what newer visits have seen again", *job)->callback([job] {
    run_thin(*job);
  });
  add_job(*world, "compact", "Write a world anew, as small as it can be", *job)->callback([job] { run_compact(*job); });
}

}  // namespace odoless
