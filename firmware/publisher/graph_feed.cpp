#include "firmware/publisher/graph_feed.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "core/geometry/matrix_rows.hpp"
#include "core/geometry/pose2_covariance.hpp"
#include "core/graph/graph_solver.hpp"
#include "core/graph/world_map.hpp"
#include "firmware/threads/round.hpp"
#include "rt/cpu_clock.hpp"

namespace odoless {
namespace {

constexpr std::size_t kScratch_bytes = std::size_t{4} << 20;  // of matches
constexpr int kNice = 10;
constexpr std::int64_t kRest = 3;  // times the CPU time of a step

/// The part of the world that the map is of.
int mapped_part(const SubmapGraph& graph) {
  return graph.anchor() < graph.graph().size() ? graph.graph().component(graph.anchor()) : graph.anchor();
}

}  // namespace

GraphFeed::GraphFeed(const RobotParams& params, std::uint64_t seed, bool lossless)
    : params_(params),
      seed_(seed),
      lossless_(lossless),
      jobs_(kJobs),
      tiles_told_(kTiles),
      thread_({.name = "odo-graph", .stack_bytes = kStack_bytes}) {
  corrections_.reserve(kCorrections);
  begin_anew();
  // Memory that was used once stays with the process (MemoryLock): what a step takes for a while is there already.
  std::vector<std::byte> scratch(scratch_bytes(params.graph));
  static_cast<volatile std::byte&>(scratch.back()) = {};
  for (Job& job : jobs_) {
    job.codes.reserve(static_cast<std::size_t>(params.graph.keyframe_beams_max));
  }
}

std::size_t GraphFeed::scratch_bytes(const GraphParams& params) {
  return kScratch_bytes + GraphSolver::kBytes_per_constraint * static_cast<std::size_t>(params.constraints_max);
}

bool GraphFeed::resume(const SubmapWorld& world, WorldUse use, const std::optional<PlaceBySubmap>& last) {
  const bool has_room = graph_->resume(world, use);
  if (last) {
    graph_->expect(*last);
  }
  is_localising_ = graph_->is_localising();
  report();
  health_.place = place_;
  drawn_part_ = mapped_part(*graph_);
  return has_room;
}

int GraphFeed::start() {
  return thread_.start([this] { run(); });
}

GraphFeed::~GraphFeed() {
  {
    const std::lock_guard lock(queue_mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  if (thread_.started()) {
    thread_.join();
  }
}

void GraphFeed::add(const Keyframe& keyframe, std::span<const BeamCode> codes) {
  std::unique_lock lock(queue_mutex_);
  if (lossless_) {
    changed_.wait(lock, [this] { return waiting() < kJobs; });
  }
  if (waiting() == kJobs) {
    ++left_out_;
    since_left_out_ = since_left_out_.then(keyframe.since_last);
    return;
  }
  Job& job = jobs_[pushed_ % kJobs];
  job.keyframe = keyframe;
  job.keyframe.since_last = std::exchange(since_left_out_, {}).then(keyframe.since_last);
  job.codes.assign(codes.begin(), codes.end());
  ++pushed_;
  if (observer_) {
    observer_(job.keyframe, job.codes);
  }
  changed_.notify_all();
  if (lossless_ && thread_.started()) {
    changed_.wait(lock, [this] { return waiting() == 0 && !is_busy_; });
  }
}

void GraphFeed::run() {
  static_cast<void>(setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice));
  bool has_work = false;
  bool has_drawing = false;
  while (true) {
    {
      std::unique_lock lock(queue_mutex_);
      is_busy_ = has_work;
      changed_.notify_all();
      changed_.wait(lock, [&] {
        return has_work || has_drawing || waiting() > 0 || told_use_ || (has_untold_ && has_room_for_tile()) ||
               is_ending_;
      });
      if (is_ending_) {
        return;
      }
    }
    const std::int64_t start_ns = thread_cpu_ns();
    has_work = take() || has_work;
    {
      const std::lock_guard lock(graph_mutex_);
      has_work = graph_->work();
      report();
      has_drawing = draw();
    }
    if (!lossless_ && !is_hurried_) {
      sleep_ns(kRest * (thread_cpu_ns() - start_ns));
    }
  }
}

bool GraphFeed::draw() {
  if (drawn_revision_ != graph_->revision() || drawn_keyframes_ != graph_->keyframes().size()) {
    drawn_revision_ = graph_->revision();
    drawn_keyframes_ = graph_->keyframes().size();
    const int part = mapped_part(*graph_);
    const bool is_of_another_part = std::exchange(drawn_part_, part) != part;
    if (std::exchange(drawn_thinnings_, graph_->thinnings()) != graph_->thinnings() || is_of_another_part) {
      make_tiles();
    }
    tiles_->update(graph_->map());
  }
  const bool has_more = tiles_->work(graph_->map());
  has_untold_ = !hand_on();
  return has_more;
}

bool GraphFeed::hand_on() {
  while (true) {
    std::unique_lock lock(queue_mutex_);
    if (!has_room_for_tile()) {
      return false;
    }
    lock.unlock();
    Tile& tile = tiles_told_[tiles_pushed_ % kTiles];  // nobody reads it before it is counted
    const auto index = tiles_->tell(tile.cells);
    if (!index) {
      return true;
    }
    tile.record = {.stamp_ns = graph_->keyframes()[graph_->keyframes().size() - 1].stamp_ns,
                   .column = index->column,
                   .row = index->row,
                   .size_cells = WorldTiles::kSide_cells,
                   .cell_size_m = params_.slam.low.grid.resolution_m};
    lock.lock();
    ++tiles_pushed_;
  }
}

bool GraphFeed::next_tile(MapTileRecord& tile, std::span<std::uint8_t> cells) {
  const std::lock_guard lock(queue_mutex_);
  if (tiles_pushed_ == tiles_taken_) {
    return false;
  }
  const Tile& next = tiles_told_[tiles_taken_ % kTiles];
  tile = next.record;
  std::copy(next.cells.begin(), next.cells.end(), cells.begin());
  ++tiles_taken_;
  changed_.notify_all();
  return true;
}

std::optional<MapCorrection> GraphFeed::take_correction() {
  const std::lock_guard lock(queue_mutex_);
  if (corrections_.empty()) {
    return std::nullopt;
  }
  const MapCorrection next = corrections_.front();
  corrections_.erase(corrections_.begin());
  return next;
}

void GraphFeed::place(PoseRecord& pose) {
  const std::lock_guard lock(queue_mutex_);
  // Before its first keyframe is here, a map begins where the filter has it.
  if (pose.map_number != placed_number_) {
    health_.map_T_odom = pose.map_T_odom;
    health_.undrifted = 1.0;
    health_.has_drifted = false;
    return;
  }
  const Pose2 map_T_odom = filter_->follow(pose.map_T_odom, pose.odom_T_scan, pose.placements, pose.unconfirmed);
  const double turn_rad = map_T_odom.yaw_rad - pose.map_T_odom.yaw_rad;
  pose.map_T_odom = map_T_odom;
  pose.map_T_scan = map_T_odom * pose.odom_T_scan;
  pose.covariance = rows_of<3>(turned(matrix_of<3>(pose.covariance), turn_rad) + filter_->drift());
  health_.map_T_odom = map_T_odom;
  health_.place = place_;
  health_.undrifted = filter_->within_ok();
  health_.has_drifted = health_.undrifted < params_.recovery.tracking.sure_probability;
}

void GraphFeed::go_over(WorldUse use) {
  const std::lock_guard lock(queue_mutex_);
  told_use_ = use;
  changed_.notify_all();
}

bool GraphFeed::expect(const Pose2& map_T_scan) {
  const std::lock_guard lock(queue_mutex_);
  if (health_.place == WorldPlaceKnown::kSure && !is_localising_) {
    return false;
  }
  expected_map_T_scan_ = map_T_scan;
  return true;
}

Pose2 GraphFeed::to_local(const Pose2& map_T_scan) const {
  const std::lock_guard lock(queue_mutex_);
  return filter_->to_local(map_T_scan);
}

bool GraphFeed::take() {
  bool has_work = false;
  while (true) {
    std::unique_lock lock(queue_mutex_);
    if (waiting() == 0) {
      break;
    }
    is_busy_ = true;
    const Job& job = jobs_[taken_ % kJobs];  // nobody writes it while it waits
    const std::optional<Pose2> expected = std::exchange(expected_map_T_scan_, std::nullopt);
    lock.unlock();
    {
      const std::lock_guard graph_lock(graph_mutex_);
      if (job.keyframe.map_number != map_number_) {
        map_number_ = job.keyframe.map_number;
        graph_->is_localising() ? graph_->begin_path_anew(false) : begin_anew();
      }
      if (expected) {
        graph_->expect(*expected);
      }
      has_work = graph_->add(job.keyframe, job.codes) || has_work;
      follow();
      report();
    }
    lock.lock();
    ++taken_;
    lock.unlock();
    changed_.notify_all();
  }
  go_over_as_told();
  return has_work;
}

void GraphFeed::go_over_as_told() {
  std::unique_lock lock(queue_mutex_);
  const std::optional<WorldUse> use = told_use_;
  lock.unlock();
  if (use) {
    const std::lock_guard graph_lock(graph_mutex_);
    graph_->go_over(*use);
    follow();
    report();
    lock.lock();
    told_use_ = told_use_ == use ? std::nullopt : told_use_;
  }
}

void GraphFeed::follow() {
  const std::lock_guard lock(queue_mutex_);
  const bool was_localising = std::exchange(is_localising_, graph_->is_localising());
  if (was_localising == is_localising_ || !follower_) {
    return;
  }
  follower_(is_localising_ ? WorldUse::kLocalise : WorldUse::kContinue, map_number_,
            graph_->keyframes().serial(graph_->mapped_keyframes()));
  for (std::size_t i = taken_; i < pushed_; ++i) {
    const Job& job = jobs_[i % kJobs];
    observer_(job.keyframe, job.codes);
  }
}

void GraphFeed::make_tiles() {
  tiles_.emplace(params_.slam.low.beam, params_.scan, params_.slam.low.grid.resolution_m, params_.graph.keyframes_max);
}

void GraphFeed::begin_anew() {
  graph_.emplace(params_.graph, params_.limits, params_.scan, seed_);
  make_tiles();
  drawn_part_ = drawn_thinnings_ = 0;
  drawn_revision_ = drawn_keyframes_ = 0;
  const std::lock_guard lock(queue_mutex_);
  filter_.emplace(params_.graph);
}

void GraphFeed::report() {
  const SubmapGraph::Counts& counts = graph_->counts();
  const std::lock_guard lock(queue_mutex_);
  health_ = {.submaps = static_cast<std::int64_t>(graph_->map().submaps.size()),
             .loop_closures = counts.accepted - counts.taken_out,
             .keyframes = graph_->mapped_keyframes(),
             .used = graph_->used(),
             .is_localising = is_localising_,
             .keyframes_left_out = left_out_,
             .map_T_odom = health_.map_T_odom,
             .place = health_.place,
             .undrifted = health_.undrifted,
             .has_drifted = health_.has_drifted};
  place_ = graph_->is_in_world()  ? WorldPlaceKnown::kSure
           : graph_->is_guessed() ? WorldPlaceKnown::kGuessed
                                  : WorldPlaceKnown::kNo;
  while (const auto correction = graph_->take_correction()) {
    if (corrections_.size() < kCorrections) {
      corrections_.push_back(*correction);
    }
  }
  placed_number_ = map_number_;
  filter_->update(*graph_);
}

GraphHealth GraphFeed::health() const {
  const std::lock_guard lock(queue_mutex_);
  GraphHealth health = health_;
  health.is_going_over = told_use_.has_value();
  return health;
}

bool GraphFeed::look(Patience patience, const std::function<void(const SubmapGraph&, int)>& show) {
  const std::unique_lock lock(graph_mutex_, patience);
  if (lock.owns_lock()) {
    show(*graph_, map_number_);
  }
  return lock.owns_lock();
}

void GraphFeed::finish() {
  if (thread_.started()) {
    is_hurried_ = true;
    std::unique_lock lock(queue_mutex_);
    changed_.wait(lock, [this] { return waiting() == 0 && !is_busy_; });
  }
  const std::lock_guard lock(graph_mutex_);
  if (!std::exchange(is_finished_, true)) {
    graph_->finish();
  }
}

std::optional<TrajectoryCorrection> GraphFeed::write(bool is_last, OccupancyMap& map) {
  if (is_last) {
    finish();
  }
  const std::lock_guard lock(graph_mutex_);
  if (graph_->submaps().empty()) {
    return std::nullopt;
  }
  const LslamParams& low = params_.slam.low;
  map = render_world(graph_->map(), low.beam, params_.scan, low.grid.resolution_m);
  return graph_->correction();
}

}  // namespace odoless
