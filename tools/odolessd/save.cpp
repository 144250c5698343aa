#include "tools/odolessd/save.hpp"

#include <array>
#include <exception>
#include <nlohmann/json.hpp>

#include "firmware/health/health_text.hpp"
#include "tools/output/map_files.hpp"
#include "tools/output/map_picture.hpp"
#include "tools/output/sha256.hpp"
#include "tools/output/trajectory.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

constexpr Rgb kPathColour{220, 50, 32};

nlohmann::ordered_json stage_summary(const StageHealth& stage) {
  return {{"scans", stage.scans},
          {"cpu_p50_ms", stage.p50_ms},
          {"cpu_p99_ms", stage.p99_ms},
          {"cpu_max_ms", stage.max_ms},
          {"deadline_misses", stage.deadline_misses}};
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
  summary["reconnects"] = health.lrf.reconnects;
  summary["datagrams_lost"] = health.lrf.datagrams_lost;
  summary["records_dropped"] = health.records_dropped;
  summary["page_faults"] = health.page_faults;
  summary["heap_calls"] = health.allocations;
  summary["sensor"] = stage_summary(health.stages[kSensorStage]);
  summary["matcher"] = stage_summary(health.stages[kMatcherStage]);
  summary["filter"] = stage_summary(health.stages[kFilterStage]);
  return summary;
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
