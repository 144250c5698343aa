#include "firmware/publisher/publisher.hpp"

#include <utility>

#include "firmware/daemon/log.hpp"
#include "firmware/health/health_text.hpp"
#include "firmware/lcm/messages.hpp"

namespace odoless {

Publisher::Publisher(const PublisherParams& params, const GridGeometry& geometry, Pipeline& pipeline,
                     const std::filesystem::path& folder)
    : pipeline_(pipeline),
      link_(params.lcm, static_cast<std::size_t>(geometry.columns) * static_cast<std::size_t>(geometry.rows)),
      recorder_(params.recorder),
      monitor_(params.health),
      map_(geometry),
      cloud_(params.mapping ? std::make_unique<CloudFeed>(*params.mapping, pipeline.pool.beams_max(), params.mount)
                            : nullptr),
      live_(params.has_page ? std::make_unique<LiveView>(geometry) : nullptr),
      poses_(folder),
      wants_link_(!params.lcm.url.empty()),
      overview_ns_(static_cast<std::int64_t>(params.lcm.overview_s * 1e9)),
      map_refresh_ns_(static_cast<std::int64_t>(params.lcm.map_refresh_s * 1e9)),
      tile_cells_(std::tuple_size_v<WorldTiles::Occupancy>) {
  last_ranges_m_.reserve(static_cast<std::size_t>(pipeline.pool.beams_max()));
  link_.set_laser(params.laser);
  if (!params.recorder.path.empty()) {
    link_.set_tap(&recorder_);
  }
}

void Publisher::attach(const RobotParams& robot, std::uint64_t seed) {
  graph_ = std::make_unique<GraphFeed>(robot, seed, pipeline_.lossless);
}

void Publisher::keep_world(const WorldParams& params, const SessionRecord& session) {
  world_ = std::make_unique<WorldKeeper>(params, session);
  graph_->tell([this](const Keyframe& keyframe, std::span<const BeamCode> codes) { world_->add(keyframe, codes); },
               [this](WorldUse use, int map_number, int next_serial) { world_->follow(use, map_number, next_serial); });
}

// The file follows the graph; but mapping goes on only where the file can be written.
void Publisher::go_over(WorldUse use) {
  use == WorldUse::kContinue&& world_ ? world_->begin_mapping() : graph_->go_over(use);
}

// In this order: a file that has to follow is told so before the graph has gone over.
std::optional<WorldStatus> Publisher::world_status() const {
  if (!graph_) {
    return std::nullopt;
  }
  const GraphHealth graph = graph_->health();
  return WorldStatus{graph, world_ ? std::optional(world_->report()) : std::nullopt};
}

int Publisher::start_graph() {
  const int error = graph_ ? graph_->start() : 0;
  return error == 0 && world_ ? world_->start(*graph_) : error;
}

void Publisher::round(std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  drain(pipeline_.gpio);
  drain(pipeline_.sensor.outbox);
  drain(pipeline_.matcher.outbox, &pipeline_.sensor.outbox);
  drain(pipeline_.filter.outbox);
  log_events(pipeline_.sensor.log);
  log_events(pipeline_.matcher.log);
  log_events(pipeline_.filter.log);
  take_corrections_of_graph();
  take_tiles_of_graph();
  refresh_tiles(now_ns);
  publish_cloud();
  watch(now_ns);
  publish_overview(now_ns);
  keep_link_open(now_ns);
}

void Publisher::keep_link_open(std::int64_t now_ns) {
  if (!link_.is_open() && wants_link_ && now_ns >= next_open_ns_) {
    next_open_ns_ = now_ns + kReopen_ns;
    link_refuses_ = link_.open() == Errc::kOk;  // until now it did
  }
}

void Publisher::drain(Outbox& outbox, Outbox* before) {
  while (const auto record = outbox.ring().front()) {
    if (before != nullptr) {
      drain(*before);
    }
    take(static_cast<RecordType>(record->type), record->bytes);
    outbox.ring().pop();
  }
}

// What cannot be sent is counted by the link, which is all that there is to be done.
void Publisher::take(RecordType type, std::span<const std::byte> bytes) {
  switch (type) {
    case RecordType::kScan:
      return take_scan(bytes);
    case RecordType::kRawBytes:
      return static_cast<void>(
          link_.publish(record_of<RawBytesRecord>(bytes), elements_of<std::byte, RawBytesRecord>(bytes)));
    case RecordType::kTilt:
      return take_tilt(bytes);
    case RecordType::kMotion:
      return take_motion(bytes);
    case RecordType::kPath:
      return take_path(elements_of<StampedPose, PathRecord>(bytes));
    case RecordType::kPose:
      return take_pose(bytes);
    case RecordType::kMapTile:
      return take_tile(record_of<MapTileRecord>(bytes), elements_of<std::uint8_t, MapTileRecord>(bytes));
    case RecordType::kKeyframe:
      return take_keyframe(bytes);
    case RecordType::kEvent:
      return;
  }
}

void Publisher::take_scan(std::span<const std::byte> bytes) {
  last_scan_ = record_of<ScanRecord>(bytes);
  const std::span<const float> ranges_m = elements_of<float, ScanRecord>(bytes);
  last_ranges_m_.assign(ranges_m.begin(), ranges_m.end());
  if (cloud_) {
    cloud_->add(last_scan_, ranges_m);
  }
  static_cast<void>(link_.publish(last_scan_, ranges_m));
}

void Publisher::take_tilt(std::span<const std::byte> bytes) {
  const auto tilt = record_of<TiltRecord>(bytes);
  if (cloud_) {
    cloud_->add(tilt);
  }
  static_cast<void>(link_.publish(tilt));
}

void Publisher::take_motion(std::span<const std::byte> bytes) {
  const auto motion = record_of<Motion>(bytes);
  if (cloud_) {
    cloud_->add(motion);
  }
  static_cast<void>(link_.publish(motion));
}

void Publisher::take_pose(std::span<const std::byte> bytes) {
  auto pose = record_of<PoseRecord>(bytes);
  const Pose2 odom_T_local = pose.map_T_odom.inverse();
  if (graph_) {
    graph_->place(pose);
  }
  map_T_local_ = pose.map_T_odom * odom_T_local;
  poses_.add(pose);
  if (world_) {
    world_->add(StampedPose{pose.stamp_ns, pose.odom_T_scan}, pose.map_number);
  }
  last_pose_ = pose;
  ++poses_counted_;
  if (cloud_) {
    cloud_->add(pose);
  }
  if (live_) {
    live_->take(pose);
  }
  static_cast<void>(link_.publish(pose));
  if (pose.stamp_ns == last_scan_.stamp_ns) {
    if (live_) {
      live_->take(pose, last_scan_, last_ranges_m_);
    }
    static_cast<void>(link_.publish_points(pose, last_scan_, last_ranges_m_));
  }
}

// As the filter has it around the robot.
void Publisher::take_path(std::span<const StampedPose> path) {
  if (cloud_) {
    path_.assign(path.begin(), path.end());
    for (StampedPose& pose : path_) {
      pose.map_T_scan = map_T_local_ * pose.map_T_scan;
    }
    cloud_->correct(path_);
  }
}

void Publisher::take_keyframe(std::span<const std::byte> bytes) {
  if (graph_) {
    graph_->add(record_of<Keyframe>(bytes), elements_of<BeamCode, Keyframe>(bytes));
  }
}

// A few a round, so that poses don't wait behind them.
void Publisher::take_corrections_of_graph() {
  while (const auto correction = graph_ ? graph_->take_correction() : std::nullopt) {
    static_cast<void>(link_.publish(*correction));
    if (is_far(*correction)) {
      log_line(EventPriority::kNotice, correction_text(*correction));
    }
  }
}

void Publisher::take_tiles_of_graph() {
  constexpr int kTilesPerRound = 4;
  MapTileRecord tile;
  for (int i = 0; graph_ && i < kTilesPerRound && graph_->next_tile(tile, tile_cells_); ++i) {
    take_tile(tile, tile_cells_);
  }
}

void Publisher::refresh_tiles(std::int64_t now_ns) {
  if (!graph_ || !link_.is_open()) {
    return;
  }
  const double share =
      static_cast<double>(now_ns - std::exchange(refreshed_ns_, now_ns)) / static_cast<double>(map_refresh_ns_);
  tiles_owed_ += std::min(share, 1.0) * map_.tiles(WorldTiles::kSide_cells);
  MapTileRecord tile{.stamp_ns = last_scan_.stamp_ns, .size_cells = WorldTiles::kSide_cells};
  while (tiles_owed_ >= 1.0) {
    tiles_owed_ -= 1.0;
    if (map_.next_tile(tile, tile_cells_)) {
      static_cast<void>(link_.publish(tile, tile_cells_));
    }
  }
}

void Publisher::take_tile(const MapTileRecord& tile, std::span<const std::uint8_t> cells) {
  if (!graph_ || !last_pose_ || map_.is_near(tile, last_pose_->map_T_scan)) {
    map_.update(tile, cells);
  }
  if (live_) {
    live_->take(tile, cells);
  }
  map_changed_ = true;
  static_cast<void>(link_.publish(tile, cells));
}

// A few pieces a round, so that poses don't wait behind them.
void Publisher::publish_cloud() {
  constexpr int kPiecesPerRound = 2;
  if (!cloud_) {
    return;
  }
  cloud_->work();
  for (int i = 0; i < kPiecesPerRound; ++i) {
    const CloudPiece piece = cloud_->next_piece(kCloudPointsMax);
    if (piece.points.empty()) {
      return;
    }
    static_cast<void>(link_.publish(piece));
  }
}

void Publisher::watch(std::int64_t now_ns) {
  pipeline_.sensor.report.update();
  pipeline_.matcher.report.update();
  pipeline_.filter.report.update();
  surroundings_.scan_queue_high_water = static_cast<std::int32_t>(pipeline_.scans.high_water());
  surroundings_.motion_queue_high_water = static_cast<std::int32_t>(pipeline_.motions.high_water());
  surroundings_.records_dropped = pipeline_.lossless ? 0 : pipeline_.records_dropped();
  surroundings_.publish_errors = link_.counters().errors;
  const int kept_error = recorder_.counters().last_error != 0 ? recorder_.counters().last_error : poses_.error();
  surroundings_.storage_error = kept_error != 0 ? kept_error : surroundings_.save_error;
  if (const WorldReport world = world_ ? world_->report() : WorldReport{}; world_) {
    surroundings_.world = {world.uuid, world.revision, world.is_read_only};
    surroundings_.checkpoint_age_s = world.age_s;
    surroundings_.storage_error = world.error != 0 ? world.error : surroundings_.storage_error;
  }
  surroundings_.cloud = cloud_ ? std::optional(cloud_->health()) : std::nullopt;
  surroundings_.graph = graph_ ? std::optional(graph_->health()) : std::nullopt;
  take_rate(now_ns);
  const HealthReport before = health_;
  health_ = monitor_.update(pipeline_.sensor.report.value(), pipeline_.matcher.report.value(),
                            pipeline_.filter.report.value(), surroundings_, now_ns);
  const bool changed = health_.state != before.state || health_.reasons != before.reasons;
  if (changed || now_ns >= next_health_ns_) {
    next_health_ns_ = now_ns + kHealth_ns;
    if (live_) {
      live_->take(make_status());
    }
    static_cast<void>(link_.publish(health_));
  }
  tell_of_link();
  if (health_.state != before.state) {
    log_line(health_.state == HealthState::kOk ? EventPriority::kInfo : EventPriority::kWarning,
             state_sentence(health_));
  }
}

void Publisher::take_rate(std::int64_t now_ns) {
  constexpr std::int64_t kOver_ns = 1'000'000'000;
  if (now_ns - rate_taken_ns_ >= kOver_ns) {
    poses_hz_ = std::exchange(poses_counted_, 0) * 1e9 / static_cast<double>(now_ns - rate_taken_ns_);
    rate_taken_ns_ = now_ns;
  }
}

// One that was never open is told of by who tries to open it.
void Publisher::tell_of_link() {
  const bool refuses = (health_.reasons & kReasonPublishing) != 0;
  if (!link_.is_open() || refuses == std::exchange(link_refuses_, refuses)) {
    return;
  }
  log_line(refuses ? EventPriority::kWarning : EventPriority::kNotice,
           refuses ? "LCM: messages cannot be sent: is the network up, and has it a route for multicast (ip route add "
                     "224.0.0.0/4 dev lo)? All else goes on"
                   : "LCM: messages are sent");
}

void Publisher::publish_overview(std::int64_t now_ns) {
  if (map_changed_ && now_ns >= next_overview_ns_) {
    map_changed_ = false;
    next_overview_ns_ = now_ns + overview_ns_;
    static_cast<void>(link_.publish(map_.view(now_ns)));
  }
}

void Publisher::set_surroundings(const Surroundings& surroundings, std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  surroundings_ = surroundings;
  watch(now_ns);
}

void Publisher::set_health_params(const HealthParams& params) {
  const std::lock_guard lock(mutex_);
  monitor_.set_params(params);
}

HealthReport Publisher::health() const {
  const std::lock_guard lock(mutex_);
  return health_;
}

DaemonStatus Publisher::status() const {
  const std::lock_guard lock(mutex_);
  return make_status();
}

DaemonStatus Publisher::make_status() const {
  return {.health = health_,
          .pose = last_pose_,
          .map = map_.size(),
          .poses_hz = poses_hz_,
          .world = world_ ? std::optional(world_->report()) : std::nullopt};
}

CpuHistograms Publisher::cpu() const {
  const std::lock_guard lock(mutex_);
  return {pipeline_.sensor.report.value().stage.cpu, pipeline_.matcher.report.value().stage.cpu,
          pipeline_.filter.report.value().stage.cpu, pipeline_.filter.report.value().with_matcher};
}

OccupancyMap Publisher::map() {
  const std::lock_guard lock(mutex_);
  return map_.map();
}

std::optional<PoseStream::Change> Publisher::write_world(bool is_last, OccupancyMap& map) {
  std::optional<TrajectoryCorrection> correction = graph_ ? graph_->write(is_last, map) : std::nullopt;
  if (!correction) {
    return std::nullopt;
  }
  PoseStream odometry = poses(take_odometry);
  for (std::span<const StampedPose> piece = odometry.next(); !piece.empty(); piece = odometry.next()) {
    correction->survey(piece);
  }
  return take_corrected(std::move(*correction));
}

std::vector<Point3> Publisher::cloud() {
  std::vector<Point3> points;
  for (std::size_t key = 0; cloud_; ++key) {
    const std::lock_guard lock(mutex_);
    const KeyedCloud& cloud = cloud_->cloud();
    if (key >= cloud.keys().size()) {
      break;
    }
    points.reserve(cloud.size());
    const Pose3 map_T_key = Pose3::of(cloud.keys()[key].map_T_key);
    for (const CloudPoint& point : cloud.points_of(key)) {
      points.push_back(map_T_key * Point3{point.x_m, point.y_m, point.z_m});
    }
  }
  return points;
}

std::vector<Point3> Publisher::final_cloud(std::span<const StampedPose> path) {
  if (cloud_) {
    const std::lock_guard lock(mutex_);
    cloud_->finish(path);
  }
  return cloud();
}

}  // namespace odoless
