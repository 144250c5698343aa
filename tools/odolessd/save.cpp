#include "tools/odolessd/save.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <exception>
#include <new>
#include <nlohmann/json.hpp>
#include <vector>

#include "firmware/health/health_text.hpp"
#include "tools/command/error.hpp"
#include "tools/output/cloud_files.hpp"
#include "tools/output/map_files.hpp"
#include "tools/output/map_picture.hpp"
#include "tools/output/result_folder.hpp"
#include "tools/output/sha256.hpp"
#include "tools/output/trajectory.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

constexpr Rgb kPathColour{220, 50, 32};

double in_ms(std::int64_t duration_ns) { return static_cast<double>(duration_ns) * 1e-6; }

double in_s(std::int64_t time_ns) { return static_cast<double>(time_ns) * 1e-9; }

/// Pairs [end of bucket in ms, scans]; empty buckets are left out.
nlohmann::ordered_json histogram_of(const LatencyHistogram& cpu) {
  nlohmann::ordered_json histogram = nlohmann::ordered_json::array();
  for (std::size_t bucket = 0; bucket < LatencyHistogram::buckets(); ++bucket) {
    if (cpu.count_in(bucket) > 0) {
      histogram.push_back({in_ms(LatencyHistogram::end_ns(bucket)), cpu.count_in(bucket)});
    }
  }
  return histogram;
}

/// The longest first; times of CLOCK_MONOTONIC.
nlohmann::ordered_json rounds_of(LongestRounds longest) {
  std::ranges::sort(longest, std::ranges::greater{}, &RoundTime::cpu_ns);
  nlohmann::ordered_json rounds = nlohmann::ordered_json::array();
  for (const RoundTime& round : longest) {
    if (round.cpu_ns > 0) {
      rounds.push_back({in_s(round.begin_ns), in_s(round.end_ns), in_ms(round.cpu_ns)});
    }
  }
  return rounds;
}

nlohmann::ordered_json cpu_summary(const LatencyHistogram& cpu) {
  return {{"scans", cpu.count()},
          {"cpu_mean_ms", in_ms(cpu.mean())},
          {"cpu_p50_ms", in_ms(cpu.percentile(50.0))},
          {"cpu_p99_ms", in_ms(cpu.percentile(99.0))},
          {"cpu_max_ms", in_ms(cpu.max())},
          {"cpu_histogram_ms", histogram_of(cpu)}};
}

nlohmann::ordered_json stage_summary(const StageHealth& stage, const LatencyHistogram& cpu) {
  nlohmann::ordered_json summary = cpu_summary(cpu);
  summary["scans"] = stage.scans;
  summary["longest_rounds_begin_s_end_s_cpu_ms"] = rounds_of(stage.longest);
  summary["budget_ms"] = stage.budget_ms;
  summary["deadline_misses"] = stage.deadline_misses;
  return summary;
}

nlohmann::ordered_json summary_of(const DaemonResult& result) {
  const HealthReport& health = result.health;
  nlohmann::ordered_json summary;
  summary["scans"] = result.trajectory.size();
  summary["wall_s"] = result.wall_s;
  summary["state"] = name_of(health.state);
  summary["reasons"] = reasons_text(health.reasons);
  summary["latched_reasons"] = reasons_text(health.latched_reasons);
  summary["scans_accepted"] = health.lrf.accepted;
  summary["scans_rejected"] = health.lrf.rejected;
  summary["motions_refused"] = health.lrf.motions_refused;
  summary["messages_forged"] = health.lrf.forged;
  summary["messages_replayed"] = health.lrf.replayed;
  summary["scans_dropped"] = health.lrf.dropped;
  summary["scans_late"] = health.lrf.late;
  summary["scan_times"] = times_text(health.lrf.times);
  summary["reconnects"] = health.lrf.reconnects;
  summary["datagrams_lost"] = health.lrf.datagrams_lost;
  summary["records_dropped"] = health.records_dropped;
  summary["updates_cut"] = health.updates_cut;
  summary["page_faults"] = health.page_faults;
  summary["heap_calls"] = health.allocations;
  if (health.cloud) {
    summary["cloud_points"] = health.cloud->points;
    summary["cloud_used"] = health.cloud->used;
    summary["cloud_refused"] = health.cloud->refused;
    summary["cloud_scans_left_out"] = health.cloud->scans_left_out;
  }
  summary["sensor"] = stage_summary(health.stages[kSensorStage], result.cpu.sensor);
  summary["matcher"] = stage_summary(health.stages[kMatcherStage], result.cpu.matcher);
  summary["filter"] = stage_summary(health.stages[kFilterStage], result.cpu.filter);
  summary["matcher_and_filter"] = cpu_summary(result.cpu.matcher_and_filter);
  return summary;
}

void write_cloud(const std::filesystem::path& folder, const DaemonResult& result) {
  const HeightColours colours(result.cloud);
  switch (result.cloud_format) {
    case CloudFormat::kNone:
      return;
    case CloudFormat::kPly:
      return write_cloud_ply(folder / "cloud.ply", result.cloud, colours);
    case CloudFormat::kPcd:
      return write_cloud_pcd(folder / "cloud.pcd", result.cloud, colours);
  }
}

/// Writes a trajectory of any length, as the robot's, and returns as many of its poses as a picture shows.
std::vector<Pose2> write_stream(const std::filesystem::path& path, PoseStream& stream, const LaserPlace& laser,
                                const SaveProgress& tell) {
  constexpr std::size_t kShown_max = 200'000;
  const std::size_t every = stream.size() / kShown_max + 1;
  const std::string name = path.filename().string();
  std::vector<Pose2> shown;
  WholeFile file(path);
  std::size_t done = 0;
  for (std::span<const StampedPose> piece = stream.next(); !piece.empty(); piece = stream.next()) {
    const std::vector<StampedPose> poses = robot_trajectory(piece, laser);
    file.append(format_trajectory(poses));
    for (const StampedPose& pose : poses) {
      if (done++ % every == 0) {
        shown.push_back(pose.map_T_scan);
      }
    }
    tell(fmt::format("writing {}: {} of {} poses", name, done, stream.size()));
  }
  if (stream.error() != 0) {
    throw IoError("the poses of the run cannot be read back: " + system_reason(stream.error()), stream.error());
  }
  file.finish();
  return shown;
}

void write_all(const std::filesystem::path& folder, DaemonResult& result, const SaveProgress& tell) {
  nlohmann::ordered_json summary = summary_of(result);
  std::array path{ColouredPath{{}, kPathColour, "path (final)"}};
  if (result.has_trajectory) {
    path[0].poses = write_stream(folder / "trajectory.tum", result.trajectory, result.laser, tell);
    static_cast<void>(write_stream(folder / "trajectory_online.tum", result.online_trajectory, result.laser, tell));
    summary["sha256"] = sha256_of_file(folder / "trajectory.tum");
  }
  if (result.map.width_cells > 0) {
    tell("writing map.pgm");
    write_map(folder, result.map);
    tell("writing map.png");
    write_map_picture(folder / "map.png", result.map, path, "odoless: the map of this run");
  }
  tell("writing the 3D map");
  write_cloud(folder, result);
  tell("writing summary.json");
  write_whole_file(folder / kSummaryFile, summary.dump(2) + "\n");
}

std::filesystem::path save_into(const std::filesystem::path& folder, bool is_forced,
                                const std::function<void(const std::filesystem::path&)>& write) {
  ResultFolder results(folder, is_forced);
  write(results.unfinished());
  results.finish();
  return folder;
}

}  // namespace

SaveOutcome save_result(RunFolder& run, const SaveRequest& request, const std::function<DaemonResult()>& result_now,
                        const SaveProgress& tell) {
  const auto write = [&](const std::filesystem::path& folder) {
    DaemonResult result = result_now();
    write_all(folder, result, tell);
  };
  try {
    return {
        .folder =
            (request.folder.empty() ? run.save(write) : save_into(request.folder, request.is_forced, write)).string()};
  } catch (const UserError& error) {
    return {.wrong = error.what(), .error = error.error_number() != 0 ? error.error_number() : EIO};
  } catch (const std::bad_alloc&) {
    return {.wrong = "memory does not suffice", .error = ENOMEM};
  } catch (const std::exception& error) {
    return {.wrong = error.what(), .error = EIO};
  }
}

}  // namespace odoless
