#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "config/robot_params.hpp"
#include "core/graph/submap_graph.hpp"
#include "core/graph/trajectory_correction.hpp"
#include "core/grid/occupancy_map.hpp"
#include "firmware/records/health.hpp"
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

  using Patience = std::chrono::milliseconds;
  using Observer = std::function<void(const Keyframe&, std::span<const BeamCode>)>;

  /// @param lossless  No keyframe is left out: `add` waits.
  GraphFeed(const RobotParams& params, std::uint64_t seed, bool lossless);
  /// Starts the thread. @return  0, or the errno for which there is none.
  [[nodiscard]] int start();
  ~GraphFeed();
  GraphFeed(const GraphFeed&) = delete;
  GraphFeed& operator=(const GraphFeed&) = delete;

  /// Before the first keyframe: told each that is not left out, by who adds it.
  void tell(Observer observer) { observer_ = std::move(observer); }
  /// Another map number than before begins anew.
  void add(const Keyframe& keyframe, std::span<const BeamCode> codes);

  /// What it has come to.
  [[nodiscard]] GraphHealth health() const;
  /// Shows the graph and its map number, unless it is at work for longer than that. @return  Whether it was shown.
  [[nodiscard]] bool look(Patience patience, const std::function<void(const SubmapGraph&, int)>& show);
  /// The run is over: works on all that waits, and ends the graph. Once; later calls do nothing.
  void finish();
  /// The map as known now, and what corrects the trajectory; none where there is no submap yet, and nothing is written.
  /// Allocates, and holds up the graph meanwhile.
  /// @param is_last  The run is over: it is finished before.
  [[nodiscard]] std::optional<TrajectoryCorrection> write(bool is_last, OccupancyMap& map);

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
  /// For `health`; whoever holds graph_mutex_.
  void report();
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
  GraphHealth health_;
  Observer observer_;
  mutable std::timed_mutex graph_mutex_;
  std::optional<SubmapGraph> graph_;  ///< always there; begun anew with another map
  int map_number_ = 0;
  bool is_finished_ = false;
  RealTimeThread thread_;
};

}  // namespace odoless
