#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "core/grid/grid_geometry.hpp"
#include "firmware/health/health_monitor.hpp"
#include "firmware/health/status.hpp"
#include "firmware/health/world_status.hpp"
#include "firmware/lcm/lcm_link.hpp"
#include "firmware/lcm/log_writer.hpp"
#include "firmware/pipeline/pipeline.hpp"
#include "firmware/publisher/cloud_feed.hpp"
#include "firmware/publisher/graph_feed.hpp"
#include "firmware/publisher/map_store.hpp"
#include "firmware/publisher/pose_spool.hpp"
#include "firmware/publisher/pose_stream.hpp"
#include "firmware/web/live_view.hpp"
#include "firmware/world/world_keeper.hpp"
#include "rt/clock.hpp"

namespace odoless {

struct PublisherParams {
  LcmParams lcm;
  LogWriterParams recorder;
  HealthParams health;
  LrfDriver laser = LrfDriver::kLcm;
  std::optional<MappingParams> mapping{};  ///< none: no 3D map
  LaserMountParams mount{};                ///< of the laser
  bool has_page = false;
};

/// The ordinary thread behind the real-time ones: takes what they say, publishes and records it, keeps map and poses,
/// and says how the daemon is.
///
/// Thread: publisher thread; `health` and those marked so from any.
class Publisher {
 public:
  /// @param folder  For the poses of the run; may be empty.
  Publisher(const PublisherParams& params, const GridGeometry& geometry, Pipeline& pipeline,
            const std::filesystem::path& folder);

  [[nodiscard]] LcmLink& link() { return link_; }
  /// What a page shows; null: there is none.
  [[nodiscard]] const LiveView* live() const { return live_.get(); }

  /// Before the first round: the pose graph is fed, and what is saved is its own.
  void attach(const RobotParams& robot, std::uint64_t seed);
  /// After the graph: what it is fed with is kept in a world file as well.
  void keep_world(const WorldParams& params, const SessionRecord& session);
  /// Null: there is none.
  [[nodiscard]] WorldKeeper* world() { return world_.get(); }
  /// Starts the threads of graph and world file, where they are. @return  0, or an errno.
  [[nodiscard]] int start_graph();
  /// Threads that `start_graph` starts.
  [[nodiscard]] int threads() const { return (graph_ ? 1 : 0) + (world_ ? 1 : 0); }
  /// Before the graph starts: opens the world file, and has the graph go on with it. Nothing where none is kept.
  FileFailure open_world() { return world_ ? world_->open(*graph_) : FileFailure{}; }
  /// Any thread: while it is not known where the robot is in the world, it may be there. @return  Whether that is so.
  bool expect(const Pose2& map_T_scan) { return graph_ && graph_->expect(map_T_scan); }
  /// Any thread: has the pose graph, and with it the world file, go over to that. It takes a while: `world_status`.
  void go_over(WorldUse use);
  /// Any thread; none without a pose graph.
  [[nodiscard]] std::optional<WorldStatus> world_status() const;
  /// Any thread: a pose of the map frame in the filter's own map.
  [[nodiscard]] Pose2 to_local(const Pose2& map_T_scan) const {
    return graph_ ? graph_->to_local(map_T_scan) : map_T_scan;
  }

  /// Takes all that waits; to be called every few milliseconds, and once when the other threads have ended.
  void round(std::int64_t now_ns);

  /// Any thread: what the supervisor knows, which the report holds from now on.
  void set_surroundings(const Surroundings& surroundings, std::int64_t now_ns);
  /// Any thread: new limits.
  void set_health_params(const HealthParams& params);
  /// Any thread: the last report.
  [[nodiscard]] HealthReport health() const;
  /// Any thread: the same with the last pose and the map's size.
  [[nodiscard]] DaemonStatus status() const;
  /// Any thread.
  [[nodiscard]] CpuHistograms cpu() const;
  /// Any thread: the map until now. Waits for the round that is under way.
  [[nodiscard]] OccupancyMap map();
  /// Any thread: whether the poses are kept, and those until now.
  [[nodiscard]] bool keeps_poses() const { return poses_.is_kept(); }
  [[nodiscard]] PoseStream poses(PoseStream::Change change) { return {poses_, poses_.size(), std::move(change)}; }
  /// Any thread: the pose graph's map, and what makes the trajectory as it has it; none where there is no graph, or
  /// nothing in it yet, and nothing is written.
  [[nodiscard]] std::optional<PoseStream::Change> write_world(bool is_last, OccupancyMap& map);

  /// Any thread: the 3D map until now, point by point in the frame `map`; empty where there is none. A key at a time,
  /// so that nobody waits for long.
  [[nodiscard]] std::vector<Point3> cloud();
  /// Any thread: the same at the end, with the final trajectory.
  [[nodiscard]] std::vector<Point3> final_cloud(std::span<const StampedPose> path);

 private:
  /// @param before  What is in there was sent earlier and goes first: a motion never overtakes its scan, without which
  ///                a filter elsewhere would have to go on.
  void drain(Outbox& outbox, Outbox* before = nullptr);
  void take(RecordType type, std::span<const std::byte> bytes);
  void take_scan(std::span<const std::byte> bytes);
  void take_tilt(std::span<const std::byte> bytes);
  void take_motion(std::span<const std::byte> bytes);
  void take_pose(std::span<const std::byte> bytes);
  void take_path(std::span<const StampedPose> path);
  void take_tile(const MapTileRecord& tile, std::span<const std::uint8_t> cells);
  void take_corrections_of_graph();
  void take_tiles_of_graph();
  /// Publishes a share of all tiles again, so that who listens from now on has the whole map after the refresh time.
  void refresh_tiles(std::int64_t now_ns);
  void take_keyframe(std::span<const std::byte> bytes);
  void watch(std::int64_t now_ns);
  void publish_cloud();
  void publish_overview(std::int64_t now_ns);
  void keep_link_open(std::int64_t now_ns);
  void tell_of_link();
  void take_rate(std::int64_t now_ns);
  [[nodiscard]] DaemonStatus make_status() const;

  static constexpr std::int64_t kHealth_ns = 100'000'000;
  static constexpr std::int64_t kReopen_ns = 2'000'000'000;

  mutable std::mutex mutex_;
  Pipeline& pipeline_;
  LcmLink link_;
  LogWriter recorder_;
  HealthMonitor monitor_;
  Surroundings surroundings_;
  HealthReport health_;
  MapStore map_;
  std::unique_ptr<CloudFeed> cloud_;    ///< null: there is none
  std::unique_ptr<GraphFeed> graph_;    ///< null: there is none
  std::unique_ptr<WorldKeeper> world_;  ///< null: there is none; ends before the graph
  std::unique_ptr<LiveView> live_;      ///< null: there is none
  PoseSpool poses_;
  bool wants_link_;
  bool link_refuses_ = false;  ///< messages, and it is told
  std::int64_t next_open_ns_ = 0;
  std::int64_t overview_ns_;
  std::int64_t map_refresh_ns_;
  std::int64_t next_overview_ns_ = 0;
  std::int64_t next_health_ns_ = 0;
  ScanRecord last_scan_;
  std::optional<PoseRecord> last_pose_;
  int poses_counted_ = 0;  ///< since the rate was taken
  std::int64_t rate_taken_ns_ = 0;
  double poses_hz_ = 0.0;
  std::vector<float> last_ranges_m_;
  Pose2 map_T_local_{};  ///< where the filter's own map lies, around the robot
  std::vector<StampedPose> path_;
  std::vector<std::uint8_t> tile_cells_;
  std::int64_t refreshed_ns_ = 0;
  double tiles_owed_ = 0.0;
  bool map_changed_ = false;
};

}  // namespace odoless
