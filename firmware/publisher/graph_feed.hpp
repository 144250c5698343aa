#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "config/robot_params.hpp"
#include "core/geometry/stamped_pose.hpp"
#include "core/graph/submap_graph.hpp"
#include "core/grid/occupancy_map.hpp"
#include "rt/real_time_thread.hpp"

namespace odoless {

/// The pose graph with a thread of its own, which nobody waits for: of ordinary priority, lower than others', and at
/// rest for three quarters of the time.
///
/// Memory is fixed at construction, but for what a save makes. Thread: `add` is the publisher's; the rest is any's.
class GraphFeed {
 public:
  static constexpr std::size_t kStack_bytes = std::size_t{2} << 20;
  static constexpr std::size_t kScratch_bytes = std::size_t{4} << 20;  ///< of matches and solutions

  /// What it has come to.
  struct Report {
    Pose2 map_T_odom{};
    std::int64_t submaps = 0;
    std::int64_t loop_closures = 0;
    std::int64_t keyframes_left_out = 0;  ///< since it was too busy
    double used = 0.0;                    ///< share of the fullest pool, 0 to 1
  };

  /// @param lossless  No keyframe is left out: `add` waits.
  GraphFeed(const RobotParams& params, std::uint64_t seed, bool lossless);
  /// Starts the thread. @return  0, or the errno for which there is none.
  [[nodiscard]] int start();
  ~GraphFeed();
  GraphFeed(const GraphFeed&) = delete;
  GraphFeed& operator=(const GraphFeed&) = delete;

  /// Another map number than before begins anew.
  void add(const Keyframe& keyframe, std::span<const BeamCode> codes);

  [[nodiscard]] Report report() const;
  /// The trajectory and the map as known now. Allocates, and holds up the graph meanwhile.
  /// @param odom     odom_T_scan of all scans in their order.
  /// @param is_last  The run is over: all that waits is worked on before.
  /// @return         False where there is no submap yet: nothing is written.
  [[nodiscard]] bool write(std::span<const StampedPose> odom, bool is_last, std::vector<StampedPose>& trajectory,
                           OccupancyMap& map);

 private:
  struct Job {
    Keyframe keyframe;
    std::vector<BeamCode> codes;
  };
  static constexpr std::size_t kJobs = 128;

  void run();
  /// Takes over what waits. @return  Whether there was something.
  bool take();
  void begin_anew();
  [[nodiscard]] std::size_t waiting() const { return pushed_ - taken_; }

  RobotParams params_;
  std::uint64_t seed_;
  bool lossless_;
  mutable std::mutex queue_mutex_;
  std::condition_variable changed_;
  std::vector<Job> jobs_;  ///< a ring
  std::size_t pushed_ = 0;
  std::size_t taken_ = 0;
  std::int64_t left_out_ = 0;
  OdometryStretch since_left_out_;  ///< of keyframes left out, to go with the next
  bool is_busy_ = false;
  bool is_ending_ = false;
  std::atomic<bool> is_hurried_{false};  ///< somebody waits for the end
  Report report_;
  mutable std::mutex graph_mutex_;
  std::optional<SubmapGraph> graph_;  ///< always there; begun anew with another map
  int map_number_ = 0;
  RealTimeThread thread_;
};

}  // namespace odoless
