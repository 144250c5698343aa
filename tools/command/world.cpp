#include "tools/command/world.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "firmware/world/thinned_world.hpp"
#include "firmware/world/world_reader.hpp"
#include "tools/command/error.hpp"
#include "tools/output/progress.hpp"
#include "tools/output/whole_file.hpp"
#include "tools/output/world_export.hpp"
#include "tools/output/world_merge.hpp"
#include "tools/output/world_output.hpp"

namespace odoless {
namespace {

struct WorldJob {
  std::filesystem::path file;
  std::filesystem::path other;
  std::filesystem::path out;
  WorldExport asked;
  bool json = false;
};

std::unique_ptr<StoredWorld> read(const std::filesystem::path& path, WorldFile& file) {
  open_world(path, file);
  WorldReading reading = read_world(file, RobotParams{});
  if (!reading.world) {
    throw DataError(path.string(), 0, reading.wrong, "a whole world; `odoless world check` says more");
  }
  return std::move(reading.world);
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
          {"joined_submaps", joined_submaps(world, session).size()}};
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

void run_export(const WorldJob& job) {
  WorldFile file;
  export_world(*read(job.file, file), job.file, job.asked);
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
  output->add_option("--out", job->asked.out, "Folder for the results")->required();
  output->add_flag("--force", job->asked.force, "Replace the results that are in the folder");
  output->add_option("--resolution", job->asked.resolution_m, "Side of a map cell in metres; 0: as configured")
      ->check(CLI::Range(0.0, 10.0));
  output
      ->add_option(
          "--north", job->asked.north_deg,
          "Where north is in the world's frame, in degrees counter-clockwise from x: all is turned so that north is up")
      ->check(CLI::Range(-360.0, 360.0));
  output
      ->add_option("--session", job->asked.session,
                   "Session, with those that loop closures join it with; 0: the last one")
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
