#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/publisher/graph_feed.hpp"
#include "firmware/world/world_file.hpp"
#include "firmware/world/world_mirror.hpp"
#include "firmware/world/world_params.hpp"
#include "firmware/world/world_report.hpp"
#include "rt/real_time_thread.hpp"

namespace odoless {

/// Keeps a world file up with what a daemon maps, on an ordinary thread of its own: keyframes as soon as they are
/// taken, submaps, constraints and poses when the pose graph has them. A map that is begun anew is a new session.
///
/// Where the file cannot be written, mapping goes on: what is missing is taken from the pose graph, which has it in any
/// case, as soon as there is room. Of the poses of scans the last kOdometry_max wait, half an hour at 40 Hz.
///
/// It follows the graph: when that goes over to localising, all of the world is written, and the file is closed and
/// stays the same to the last byte. To map again the file is opened first, and the graph goes over when that could be
/// done.
///
/// Memory is bounded. Thread: `add` is the publisher's, `follow` the graph's; those marked so are any's. Locks: the
/// graph's come before its own.
class WorldKeeper {
 public:
  static constexpr std::size_t kOdometry_max = 65'536;
  static constexpr std::size_t kStack_bytes = std::size_t{1} << 20;
  static constexpr std::size_t kScratch_bytes = std::size_t{6} << 20;  ///< SQLite's pages, and what waits

  /// @param session  Of its configuration; `started` is set here.
  WorldKeeper(const WorldParams& params, SessionRecord session);
  ~WorldKeeper();
  WorldKeeper(const WorldKeeper&) = delete;
  WorldKeeper& operator=(const WorldKeeper&) = delete;

  /// Opens the file, or makes it where it may grow, before anything runs, and has the graph go on with what is in it.
  /// Errors: EOVERFLOW where that has no room for it.
  FileFailure open(GraphFeed& graph);
  /// Starts the thread. @param graph  Must outlive it. @return  0, or the errno for which there is none.
  [[nodiscard]] int start(GraphFeed& graph);

  /// Every keyframe that goes to the pose graph.
  void add(const Keyframe& keyframe, std::span<const BeamCode> codes);
  /// Every scan's odom_T_scan.
  void add(const StampedPose& odom_T_scan, int map_number);
  /// The graph has gone over (GraphFeed::Follower).
  void follow(WorldUse use, int map_number, int next_serial);
  /// Any thread: opens the file again, on the keeper's thread, and has the graph go over to mapping. Refused where the
  /// file is another by now, or has changed: `report` says so.
  void begin_mapping();
  /// Any thread: no more will be added: ends the pose graph, writes all and closes the file, on its thread.
  void begin_end();
  /// Any thread.
  [[nodiscard]] bool is_ending() const;
  /// Any thread: since it last got on with that.
  [[nodiscard]] std::int64_t since_progress_ns() const;

  /// Any thread.
  [[nodiscard]] WorldReport report() const;

 private:
  /// What waits of one map.
  struct Batch {
    int map_number = 0;
    int next_serial = 0;  ///< of the graph's next keyframe; `keyframes` are the last ones before it
    std::vector<StoredKeyframe> keyframes;
    std::vector<StampedPose> odometry;
  };
  static constexpr std::size_t kKeyframes_max = 128;
  static constexpr std::size_t kMaps_max = 16;

  enum class Stage : std::uint8_t { kRunning, kToEnd, kLeft, kEnded };

  /// What the file is.
  enum class Use : std::uint8_t { kMapped, kToBeClosed, kClosed, kToBeOpened };

  [[nodiscard]] Use use() const;
  void run();
  /// One of what there is to do every second.
  void keep_up(GraphFeed::Patience patience);
  void end_mapping(GraphFeed::Patience patience);
  void reopen();
  [[nodiscard]] FileFailure open_again();
  [[nodiscard]] FileFailure begin_session(WorldPlace& place);
  void close();
  void end(Stage stage);
  void finish();
  [[nodiscard]] Batch& batch_of(int map_number);
  /// Writes what there is. @param patience  How long to wait for the graph.
  void round(GraphFeed::Patience patience);
  /// Of the oldest map. @return  Whether there is more.
  bool write_some(GraphFeed::Patience patience);
  [[nodiscard]] FileFailure make_ready();
  /// Takes what waits of the oldest map. @return  Its map number; -1: there is none.
  int take(WorldChanges& changes);
  void give_back(WorldChanges& changes);
  /// To the next map, where there is one and this one is written. @return  Whether there is more to write.
  bool begin_next_map();
  void note(const FileFailure& failed);

  WorldParams params_;
  SessionRecord session_;
  WorldFile file_;
  std::optional<WorldPlace> place_;
  WorldMirror mirror_;
  int continued_ = 0;           ///< serial of the first keyframe that the world did not have
  bool is_all_in_file_ = true;  ///< else submaps were made of keyframes that were in none
  GraphFeed* graph_ = nullptr;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Batch> batches_;
  Use use_ = Use::kMapped;
  int world_end_ = 0;  ///< serial of the first keyframe that was none of the world's when the graph went over last
  WorldReport report_;
  std::int64_t written_ns_ = 0;
  std::int64_t progress_ns_ = 0;
  Stage stage_ = Stage::kRunning;
  RealTimeThread thread_;
};

}  // namespace odoless
