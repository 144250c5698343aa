#include "tools/odolessd/save.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <nlohmann/json.hpp>

#include "firmware/health/health_text.hpp"
#include "tools/output/cloud_files.hpp"
#include "tools/output/map_files.hpp"
#include "tools/output/map_picture.hpp"
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

void write_all(const std::filesystem::path& folder, const DaemonResult& result) {
  nlohmann::ordered_json summary = summary_of(result);
  write_trajectory(folder / "trajectory.tum", result.trajectory);
  write_trajectory(folder / "trajectory_online.tum", result.online_trajectory);
  if (result.map.width_cells > 0) {
    ColouredPath path{{}, kPathColour};
    for (const StampedPose& pose : result.trajectory) {
      path.poses.push_back(pose.map_T_scan);
    }
    write_map(folder, result.map);
    write_map_picture(folder / "map.png", result.map, std::array{path});
  }
  write_cloud(folder, result);
  summary["sha256"] = sha256_of_file(folder / "trajectory.tum");
  write_whole_file(folder / "summary.json", summary.dump(2) + "\n");
}

}  // namespace

std::string save_result(const std::filesystem::path& folder, const DaemonResult& result) {
  try {
    write_all(folder, result);
    return "";
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace odoless
