#include "firmware/world/world_keeper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <utility>

#include "firmware/daemon/log.hpp"
#include "firmware/world/continued_world.hpp"
#include "firmware/world/world_reader.hpp"
#include "rt/cpu_clock.hpp"

namespace odoless {
namespace {

constexpr GraphFeed::Patience kPatience = std::chrono::milliseconds(100);
constexpr GraphFeed::Patience kAtTheEnd = std::chrono::seconds(60);

}  // namespace

WorldKeeper::WorldKeeper(const WorldParams& params, SessionRecord session)
    : params_(params), session_(std::move(session)), thread_({.name = "odo-world", .stack_bytes = kStack_bytes}) {
  report_.file = params.file;
  report_.is_read_only = params.mode == WorldUse::kLocalise;
  // Memory that was used once stays with the process (MemoryLock).
  std::vector<std::byte> scratch(kScratch_bytes);
  static_cast<volatile std::byte&>(scratch.back()) = {};
}

WorldKeeper::~WorldKeeper() {
  end(Stage::kLeft);
  if (thread_.started()) {
    thread_.join();
  }
}

FileFailure WorldKeeper::open(GraphFeed& graph) {
  FileFailure failed =
      report_.is_read_only ? file_.open_to_read(params_.file) : file_.open_to_write(params_.file, session_.program);
  ContinuedWorld world;
  failed = failed.any() ? failed : world.read(file_, graph.params(), params_.mode);
  if (const int left_out = failed.any() || report_.is_read_only ? 0 : world.make_room(file_, graph.params().graph);
      left_out > 0) {
    log_line(EventPriority::kNotice,
             fmt::format("world file {}: {} submaps are left out, of which newer visits have seen the ground",
                         params_.file, left_out));
  }
  if (const StoredWorld* const stored = world.stored(); !failed.any() && stored != nullptr) {
    mirror_ = world.mirror();
    continued_ = mirror_.next_serial();
    is_all_in_file_ = !report_.is_read_only || static_cast<int>(stored->submaps.size()) == stored->submaps_in_file;
    if (!graph.resume(stored->world(), params_.mode, last_place(*stored))) {
      failed = {EOVERFLOW, no_room_sentence(*stored, graph.params().graph)};
    }
  }
  report_.uuid = file_.identity().uuid;
  report_.revision = file_.identity().revision;
  written_ns_ = monotonic_ns();
  if (graph.health().is_localising) {
    close();
  }
  return failed;
}

int WorldKeeper::start(GraphFeed& graph) {
  graph_ = &graph;
  return thread_.start([this] { run(); });
}

void WorldKeeper::end(Stage stage) {
  const std::lock_guard lock(mutex_);
  if (stage_ == Stage::kRunning) {
    stage_ = stage;
    progress_ns_ = monotonic_ns();
    changed_.notify_all();
  }
}

void WorldKeeper::begin_end() { end(thread_.started() ? Stage::kToEnd : Stage::kEnded); }

bool WorldKeeper::is_ending() const {
  const std::lock_guard lock(mutex_);
  return stage_ == Stage::kToEnd;
}

std::int64_t WorldKeeper::since_progress_ns() const {
  const std::lock_guard lock(mutex_);
  return monotonic_ns() - progress_ns_;
}

WorldKeeper::Batch& WorldKeeper::batch_of(int map_number) {
  if (batches_.empty() || batches_.back().map_number != map_number) {
    if (batches_.size() == kMaps_max) {
      report_.keyframes_lost += batches_[1].next_serial;  // the first one may be under way
      batches_.erase(batches_.begin() + 1);
    }
    const int first = batches_.empty() ? continued_ : 0;
    batches_.push_back({.map_number = map_number, .next_serial = first, .keyframes = {}, .odometry = {}});
  }
  return batches_.back();
}

void WorldKeeper::add(const Keyframe& keyframe, std::span<const BeamCode> codes) {
  const std::lock_guard lock(mutex_);
  if (use_ != Use::kMapped) {
    return;
  }
  Batch& batch = batch_of(keyframe.map_number);
  if (batch.keyframes.size() == kKeyframes_max) {
    batch.keyframes.clear();  // the pose graph has them
  }
  batch.keyframes.push_back({keyframe, {codes.begin(), codes.end()}, batch.next_serial++});
}

void WorldKeeper::add(const StampedPose& odom_T_scan, int map_number) {
  const std::lock_guard lock(mutex_);
  if (use_ != Use::kMapped) {
    return;
  }
  std::vector<StampedPose>& odometry = batch_of(map_number).odometry;
  if (odometry.size() >= kOdometry_max) {
    constexpr std::ptrdiff_t kPart = kOdometry_max / 16;
    odometry.erase(odometry.begin(), odometry.begin() + kPart);
    report_.scans_lost += kPart;
  }
  odometry.push_back(odom_T_scan);
}

// From one beginning to the next: on a slow disk, what a write takes would come on top of the pause.
void WorldKeeper::run() {
  using SteadyClock = std::chrono::steady_clock;
  const auto period =
      std::chrono::duration_cast<SteadyClock::duration>(std::chrono::duration<double>(params_.write_every_s));
  SteadyClock::time_point begin = SteadyClock::now();
  std::unique_lock lock(mutex_);
  while (!changed_.wait_until(lock, begin + period, [this] { return stage_ != Stage::kRunning; })) {
    begin = SteadyClock::now();
    lock.unlock();
    keep_up(kPatience);
    lock.lock();
  }
  if (stage_ == Stage::kToEnd) {
    lock.unlock();
    finish();
    lock.lock();
    stage_ = Stage::kEnded;
  }
}

void WorldKeeper::finish() {
  graph_->finish();
  keep_up(kAtTheEnd);
  file_.close();
  if (const WorldReport last = report(); last.error != 0) {
    log_line(EventPriority::kError, fmt::format("world file {}: {}: {} keyframes of this run are not in it",
                                                params_.file, last.reason, last.not_written));
  }
}

void WorldKeeper::keep_up(GraphFeed::Patience patience) {
  switch (use()) {
    case Use::kMapped:
      return round(patience);
    case Use::kToBeClosed:
      round(patience);
      return end_mapping(patience);
    case Use::kToBeOpened:
      return reopen();
    case Use::kClosed:
      return;
  }
}

void WorldKeeper::round(GraphFeed::Patience patience) {
  while (write_some(patience)) {
  }
}

bool WorldKeeper::write_some(GraphFeed::Patience patience) {
  FileFailure failed = make_ready();
  WorldChanges changes;
  const int map_number = failed.any() ? -1 : take(changes);
  bool has_more = false;
  if (map_number >= 0) {
    static_cast<void>(graph_->look(patience, [&](const SubmapGraph& graph, int graph_map_number) {
      has_more = graph_map_number == map_number && mirror_.collect(graph, changes);
    }));
    failed = file_.write(*place_, changes);
    if (failed.any()) {
      give_back(changes);
    } else {
      mirror_.take(changes);
    }
    if (!failed.any() && !changes.left_out.empty()) {
      log_line(EventPriority::kNotice,
               fmt::format("world file {}: {} keyframes are left out, of which newer visits have seen the ground",
                           params_.file, changes.left_out.size()));
    }
  }
  note(failed);
  return !failed.any() && map_number >= 0 && (has_more || begin_next_map());
}

// A file that was removed or replaced is made anew: all of this session that the graph has goes there.
FileFailure WorldKeeper::make_ready() {
  if (!file_.is_open() || !file_.is_in_place()) {
    place_.reset();
    mirror_ = WorldMirror();
    if (FileFailure failed = file_.open_to_write(params_.file, session_.program); failed.any()) {
      return failed;
    }
  }
  if (place_) {
    return {};
  }
  WorldPlace place;
  FileFailure failed = begin_session(place);
  if (!failed.any()) {
    place_ = continued_ > 0 ? WorldPlace{.session = place.session} : place;
  }
  return failed;
}

FileFailure WorldKeeper::begin_session(WorldPlace& place) {
  session_.started = utc_text();
  return file_.begin(session_, place);
}

int WorldKeeper::take(WorldChanges& changes) {
  const std::lock_guard lock(mutex_);
  if (batches_.empty()) {
    return -1;
  }
  Batch& batch = batches_.front();
  changes.odometry = std::exchange(batch.odometry, {});
  const int first = batch.next_serial - static_cast<int>(batch.keyframes.size());
  if (first == mirror_.next_serial()) {  // else some are missing, which the graph has
    changes.keyframes = std::exchange(batch.keyframes, {});
  }
  batch.keyframes.clear();
  return batch.map_number;
}

void WorldKeeper::give_back(WorldChanges& changes) {
  const std::lock_guard lock(mutex_);
  std::vector<StampedPose>& odometry = batches_.front().odometry;
  odometry.insert(odometry.begin(), changes.odometry.begin(), changes.odometry.end());
}

bool WorldKeeper::begin_next_map() {
  const std::lock_guard lock(mutex_);
  if (batches_.size() < 2) {
    return false;
  }
  if (!batches_.front().keyframes.empty() || !batches_.front().odometry.empty()) {
    return true;  // came while the rest was written
  }
  report_.keyframes_lost += batches_.front().next_serial - mirror_.next_serial();
  batches_.pop_front();
  place_.reset();
  mirror_ = WorldMirror();
  continued_ = 0;
  return true;
}

void WorldKeeper::note(const FileFailure& failed) {
  int before = 0;
  {
    const std::lock_guard lock(mutex_);
    before = std::exchange(report_.error, failed.error);
    report_.reason = failed.text;
    report_.uuid = file_.is_open() ? file_.identity().uuid : report_.uuid;
    report_.revision = file_.is_open() ? file_.identity().revision : report_.revision;
    report_.keyframes = mirror_.keyframes() - mirror_.keyframes_before(continued_);
    report_.not_written = batches_.empty() ? 0 : std::max(0, batches_.front().next_serial - mirror_.next_serial());
    report_.session = place_ ? place_->session : 0;
    progress_ns_ = monotonic_ns();
    written_ns_ = failed.any() ? written_ns_ : progress_ns_;
  }
  if (failed.error != before) {
    log_line(failed.any() ? EventPriority::kError : EventPriority::kNotice,
             failed.any()
                 ? fmt::format("world file {}: {}; mapping goes on, and what is missing is written when that is "
                               "possible again",
                               params_.file, failed.text)
                 : fmt::format("world file {}: all is written again", params_.file));
  }
}

WorldReport WorldKeeper::report() const {
  const std::lock_guard lock(mutex_);
  WorldReport report = report_;
  report.is_going_over = use_ == Use::kToBeClosed || use_ == Use::kToBeOpened;
  report.age_s = report.is_read_only ? 0.0 : static_cast<double>(monotonic_ns() - written_ns_) * 1e-9;
  return report;
}

}  // namespace odoless
