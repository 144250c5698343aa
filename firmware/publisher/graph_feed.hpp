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
#include "core/graph/filter_in_world.hpp"
#include "core/graph/map_correction.hpp"
#include "core/graph/submap_graph.hpp"
#include "core/graph/trajectory_correction.hpp"
#include "core/graph/world_tiles.hpp"
#include "core/grid/occupancy_map.hpp"
#include "firmware/records/health.hpp"
#include "firmware/records/records.hpp"
#include "rt/real_time_thread.hpp"

namespace odoless {

/// The pose graph with a thread of its own, which nobody waits for: of ordinary priority, lower than others', and at
/// rest for three quarters of the time.
///
/// Memory is fixed at construction, but for what a save makes, and a few MB while a crowded world is thinned. Thread:
/// `add` is the publisher's; the rest is any's.
class GraphFeed {
 public:
  static constexpr std::size_t kStack_bytes = std::size_t{2} << 20;
  /// Of matches and solutions.
  [[nodiscard]] static std::size_t scratch_bytes(const GraphParams& params);

  using Patience = std::chrono::milliseconds;
  using Observer = std::function<void(const Keyframe&, std::span<const BeamCode>)>;
  /// What the graph does with its world from now on. @param next_serial  Of the first keyframe that is none of the
  /// world's.
  using Follower = std::function<void(WorldUse, int map_number, int next_serial)>;

  /// @param lossless  No keyframe is left out: `add` waits.
  GraphFeed(const RobotParams& params, std::uint64_t seed, bool lossless);
  /// Before it starts: goes on with a world, which is copied. @param last  Where the robot was, as a guess.
  /// @return  Whether there is room for it.
  [[nodiscard]] bool resume(const SubmapWorld& world, WorldUse use, const std::optional<PlaceBySubmap>& last);
  /// Starts the thread. @return  0, or the errno for which there is none.
  [[nodiscard]] int start();
  ~GraphFeed();
  GraphFeed(const GraphFeed&) = delete;
  GraphFeed& operator=(const GraphFeed&) = delete;

  /// Before it starts: who is told each keyframe that is not left out, by who adds it, and when the graph has gone
  /// over; then, of those that the graph does not have yet, once more. They may lock what the feed does not wait for.
  void tell(Observer observer, Follower follower) {
    observer_ = std::move(observer);
    follower_ = std::move(follower);
  }
  /// Another map number than before begins anew, or looks for the robot anew in a world that stays as it is. In a
  /// lossless replay it waits until all that comes of it is done, so that corrections go in at the same scans however
  /// fast the machine is.
  void add(const Keyframe& keyframe, std::span<const BeamCode> codes);

  /// Every pose, as the filter has it in its own map: where the world has that.
  void place(PoseRecord& pose);
  /// While it is not known where the robot is in the world that it continues, or always where that stays as it is: the
  /// robot may be there. @return  Whether that is so.
  bool expect(const Pose2& map_T_scan);
  /// The graph goes over to that as soon as it has all that waits (SubmapGraph::go_over); `health` says when it has.
  void go_over(WorldUse use);
  /// A pose of the world in the filter's own map, by the submap that is nearest to it.
  [[nodiscard]] Pose2 to_local(const Pose2& map_T_scan) const;
  /// A tile of the map that has changed: written to `cells`, WorldTiles::Occupancy of them. @return  Whether there was.
  [[nodiscard]] bool next_tile(MapTileRecord& tile, std::span<std::uint8_t> cells);

  /// The next correction of where the robot is in the map, in their order; of more than 32 that wait the first ones.
  [[nodiscard]] std::optional<MapCorrection> take_correction();

  [[nodiscard]] const RobotParams& params() const { return params_; }
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
  struct Tile {
    MapTileRecord record;
    WorldTiles::Occupancy cells;
  };
  static constexpr std::size_t kJobs = 128;
  static constexpr std::size_t kTiles = 32;
  static constexpr std::size_t kCorrections = 32;

  void run();
  /// Takes over what waits. @return  Whether there was something.
  bool take();
  void begin_anew();
  void go_over_as_told();
  /// Tells of a graph that has gone over, also by itself; whoever holds graph_mutex_.
  void follow();
  void make_tiles();
  /// Draws a little, and hands on what is drawn. @return  Whether there is more to draw; what is drawn waits for room.
  bool draw();
  /// @return  Whether all that is drawn is handed on; else there is no room.
  bool hand_on();
  [[nodiscard]] bool has_room_for_tile() const { return tiles_pushed_ - tiles_taken_ < kTiles; }
  /// For `health`, and of corrections; whoever holds graph_mutex_.
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
  OdometryStretch since_left_out_;            ///< of keyframes left out, to go with the next
  std::optional<Pose2> expected_map_T_scan_;  ///< that somebody told
  std::optional<WorldUse> told_use_;          ///< until the graph has gone over to that
  bool is_busy_ = false;
  bool has_untold_ = false;
  bool is_ending_ = false;
  std::atomic<bool> is_hurried_{false};  ///< somebody waits for the end
  GraphHealth health_;
  WorldPlaceKnown place_ = WorldPlaceKnown::kSure;  ///< of the next pose; `health_` tells of the last one
  int placed_number_ = -1;                          ///< of the map that `health_` and `filter_` are of
  std::optional<FilterInWorld> filter_;             ///< always there; begun anew with another map
  std::vector<Tile> tiles_told_;                    ///< a ring
  std::size_t tiles_pushed_ = 0;
  std::size_t tiles_taken_ = 0;
  std::vector<MapCorrection> corrections_;
  Observer observer_;
  Follower follower_;
  mutable std::timed_mutex graph_mutex_;
  std::optional<SubmapGraph> graph_;  ///< always there; begun anew with another map
  std::optional<WorldTiles> tiles_;   ///< likewise
  std::int64_t drawn_revision_ = 0;
  int drawn_keyframes_ = 0;
  int drawn_part_ = 0;
  int drawn_thinnings_ = 0;
  int map_number_ = 0;
  bool is_localising_ = false;  ///< that was told; as the rest of `health_`
  bool is_finished_ = false;
  RealTimeThread thread_;
};

}  // namespace odoless
