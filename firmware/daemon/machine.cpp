#include "firmware/daemon/machine.hpp"

#include <fmt/format.h>
#include <sysexits.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <span>
#include <utility>

#include "firmware/daemon/log.hpp"
#include "firmware/daemon/real_time_entry.hpp"
#include "firmware/daemon/stage_watch.hpp"
#include "firmware/sources/lcm_source.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kSensorBudget_ns = 5'000'000;

GridGeometry geometry_of(const FilterStage* filter) { return filter != nullptr ? filter->geometry() : GridGeometry{}; }

PublisherParams publisher_params(const DaemonParams& params) {
  return {.lcm = params.lcm,
          .recorder = params.recorder,
          .health = params.health,
          .laser = params.lrf.driver,
          .mapping = params.mapping_in_use(),
          .mount = params.robot.mount,
          .has_page = params.web.is_used()};
}

CloudFormat format_of(const std::optional<MappingParams>& mapping) {
  return mapping ? mapping->save_as : CloudFormat::kNone;
}

/// Gives each pose of a path that of the trajectory at its stamp. Both are in the order of their stamps.
void move_to(PoseStream trajectory, std::span<StampedPose> path) {
  auto at = path.begin();
  for (std::span<const StampedPose> piece = trajectory.next(); !piece.empty(); piece = trajectory.next()) {
    for (const StampedPose& pose : piece) {
      at = std::find_if(at, path.end(), [&](const StampedPose& each) { return each.stamp_ns >= pose.stamp_ns; });
      if (at != path.end() && at->stamp_ns == pose.stamp_ns) {
        at->map_T_scan = pose.map_T_scan;
      }
    }
  }
}

Lack lack_of_world(const FileFailure& failed, const WorldReport& world) {
  return {failed.error == EBADMSG     ? EX_DATAERR
          : failed.error == EBUSY     ? EX_UNAVAILABLE
          : failed.error == EOVERFLOW ? EX_CONFIG
          : world.is_read_only        ? EX_NOINPUT
                                      : EX_CANTCREAT,
          fmt::format("world file {}: {}; a world file is needed{} (--world, world.file)", world.file, failed.text,
                      world.is_read_only ? ", with a map to find the way in" : ", or a path where one can be made")};
}

/// Poses are kept for a save at the end, or for one that somebody asks for: on a disk, where there is no folder.
std::filesystem::path folder_for_poses(const DaemonOptions& options) {
  const bool can_be_asked = !options.params.control.socket.empty() && has_filter(options.stages);
  return options.folder.empty() && can_be_asked ? "/var/tmp" : options.folder;
}

}  // namespace

Machine::Machine(DaemonOptions& options)
    : stages_(options.stages),
      cloud_format_(format_of(options.params.mapping_in_use())),
      laser_(LaserPlace::of(options.params.robot.mount)),
      pipeline_(options.params.pipeline, options.params.robot, options.lossless),
      source_(make_source(options)),
      intake_(make_intake(options)),
      matcher_(has_matcher(stages_) ? std::make_unique<MatcherStage>(options.params.robot, options.seed) : nullptr),
      filter_(has_filter(stages_) ? std::make_unique<FilterStage>(options.params.robot, options.seed) : nullptr),
      publisher_(publisher_params(options.params), geometry_of(filter_.get()), pipeline_, folder_for_poses(options)),
      sensor_thread_({.name = "odo-sensor",
                      .priority = options.params.pipeline.sensor_priority,
                      .cpu = options.params.pipeline.sensor_cpu}),
      matcher_thread_({.name = "odo-matcher",
                       .priority = options.params.pipeline.matcher_priority,
                       .cpu = options.params.pipeline.matcher_cpu}),
      filter_thread_({.name = "odo-filter",
                      .priority = options.params.pipeline.filter_priority,
                      .cpu = options.params.pipeline.filter_cpu}),
      start_ns_(clock_.now_ns()) {
  const PipelineParams& params = options.params.pipeline;
  sensor_loop_ = std::make_unique<SensorLoop>(pipeline_, *source_, *intake_, clock_, kSensorBudget_ns);
  if (options.params.tilt.driver != TiltDriver::kNone && has_matcher(stages_) && source_->is_live()) {
    tilt_ = std::make_unique<TiltSource>(options.params.tilt, tilt_line_);
    tilt_->obey_stop(gpio_signals_);
    sensor_loop_->attach(*tilt_);
    intake_->attach(*tilt_);
  }
  if (matcher_) {
    matcher_loop_ = std::make_unique<MatcherLoop>(pipeline_, *matcher_, params.matcher_budget_ns, has_filter(stages_));
  }
  if (!filter_) {
    publisher_.link().send_again();
  }
  if (filter_) {
    filter_loop_ = std::make_unique<FilterLoop>(pipeline_, *filter_, params, options.params.lcm.map_refresh_s);
    if (options.params.robot.graph.enabled) {
      filter_loop_->tell_keyframes(options.params.robot.graph);
      publisher_.attach(options.params.robot, options.seed);
      if (!options.params.world.file.empty()) {
        publisher_.keep_world(options.params.world,
                              {"", options.version, options.configuration, static_cast<std::int64_t>(options.seed)});
      }
    }
    if (options.params.mapping_in_use()) {
      filter_loop_->tell_path();
    }
  }
  if (reads_laser_) {
    gpio_thread_ =
        std::make_unique<GpioThread>(options.params.gpio, gpio_signals_, clock_, pipeline_.sensor.wake, pipeline_.gpio);
  }
}

Machine::~Machine() {
  if (is_running() && !stop()) {
    ::_exit(EX_SOFTWARE);
  }
}

std::unique_ptr<ScanSource> Machine::make_source(DaemonOptions& options) {
  const DaemonParams& params = options.params;
  const Channels channels(params.lcm.prefix);
  const int beams_max = params.robot.scan.beams_max;
  if (options.source) {
    return std::move(options.source);
  }
  if (!has_matcher(stages_)) {
    return std::make_unique<LcmSource>(params.lcm, channels, beams_max);
  }
  if (params.lrf.driver == LrfDriver::kLcm) {
    return std::make_unique<LcmSource>(params.lcm, params.lrf.channel, beams_max);
  }
  reads_laser_ = true;
  auto laser = std::make_unique<LrfSource>(params.lrf, beams_max, line_);
  const GpioParams& gpio = params.gpio;
  laser->attach(gpio_signals_, gpio.sync_line.empty() ? std::nullopt : std::optional(gpio.sync_delay_ns));
  return laser;
}

std::unique_ptr<Intake> Machine::make_intake(const DaemonOptions& options) {
  if (!has_matcher(stages_)) {
    return std::make_unique<FilterIntake>(pipeline_, clock_, options.params.robot.mount, options.params.robot.limits);
  }
  const bool from_lcm = options.params.lrf.driver == LrfDriver::kLcm;
  return std::make_unique<Intake>(pipeline_, clock_, options.params.robot.mount, source_->is_live(), !from_lcm);
}

Lack Machine::open() {
  if (auto* const lcm = dynamic_cast<LcmSource*>(source_.get()); lcm != nullptr) {
    if (const Errc error = lcm->open(); error != Errc::kOk) {
      return {error == Errc::kBadAddress ? EX_CONFIG : EX_UNAVAILABLE, lcm->reason()};
    }
  }
  if (const FileFailure failed = publisher_.open_world(); failed.any()) {
    return lack_of_world(failed, publisher_.world()->report());
  }
  const Errc error = publisher_.link().open();
  if (error == Errc::kBadAddress) {
    return {EX_CONFIG, publisher_.link().reason()};
  }
  if (error != Errc::kOk) {
    log_line(EventPriority::kWarning,
             publisher_.link().reason() + "; until then nothing is published, and all else goes on");
  }
  return {};
}

int Machine::start(bool enforce) {
  const auto run = [enforce](RealTimeThread& thread, std::span<const int> calls, std::function<void()> body) {
    return thread.start([enforce, calls, body = std::move(body)] { enforce ? run_enforced(calls, body) : body(); });
  };
  const std::atomic<bool>& before_filter = matcher_ ? pipeline_.matcher.done : pipeline_.sensor.done;
  int error = gpio_thread_ ? gpio_thread_->start() : 0;
  error = error != 0 ? error : publisher_.start_graph();
  if (filter_loop_ && error == 0) {
    error = run(filter_thread_, worker_system_calls(), [this, &before_filter] { filter_loop_->run(before_filter); });
  }
  if (matcher_loop_ && error == 0) {
    error = run(matcher_thread_, worker_system_calls(), [this] { matcher_loop_->run(); });
  }
  return error != 0 ? error : run(sensor_thread_, sensor_system_calls(), [this] { sensor_loop_->run(); });
}

bool Machine::is_running() const {
  return sensor_thread_.started() || matcher_thread_.started() || filter_thread_.started();
}

void Machine::wake_all() const {
  pipeline_.sensor.wake.notify();
  pipeline_.matcher.wake.notify();
  pipeline_.filter.wake.notify();
}

bool Machine::stop() {
  pipeline_.stopping.store(true, std::memory_order_release);
  // Of a thread that could not be made, nobody else says that it has ended.
  pipeline_.sensor.done = pipeline_.sensor.done || !sensor_thread_.started();
  pipeline_.matcher.done = pipeline_.matcher.done || !matcher_thread_.started();
  pipeline_.filter.done = pipeline_.filter.done || !filter_thread_.started();
  wake_all();
  StageWatch watch(watched_stages());
  for (std::int64_t looks = 0; !has_ended(); ++looks) {
    watch.look();
    if (const StageWatch::Silence silence = watch.longest(); silence.lasts_ns > kEnd_ns) {
      log_line(EventPriority::kCritical, fmt::format("the {} stage does not end", silence.stage));
      return false;
    }
    if (looks * StageWatch::kLook_ns > kDrain_ns && !pipeline_.abandoning.exchange(true)) {
      log_line(EventPriority::kWarning, "the stages take too long: scans that still wait are left out");
      wake_all();
    }
    const std::int64_t next_ns = clock_.now_ns() + StageWatch::kLook_ns;
    while (!has_ended() && clock_.now_ns() < next_ns) {
      publisher_.round(clock_.now_ns());
      sleep_ns(kRoomWait_ns);
    }
  }
  sensor_thread_.join();
  matcher_thread_.join();
  filter_thread_.join();
  publisher_.round(clock_.now_ns());
  return true;
}

int Machine::threads() const { return kStages + 2 + (gpio_thread_ ? 1 : 0) + publisher_.threads(); }

std::size_t Machine::map_cells() const {
  const GridGeometry geometry = geometry_of(filter_.get());
  return static_cast<std::size_t>(geometry.columns) * static_cast<std::size_t>(geometry.rows);
}

std::vector<WatchedStage> Machine::watched_stages() const {
  std::vector<WatchedStage> stages{{"sensor", &sensor_thread_, &pipeline_.sensor.heartbeat, &pipeline_.sensor.done}};
  if (matcher_) {
    stages.push_back({"matcher", &matcher_thread_, &pipeline_.matcher.heartbeat, &pipeline_.matcher.done});
  }
  if (filter_) {
    stages.push_back({"filter", &filter_thread_, &pipeline_.filter.heartbeat, &pipeline_.filter.done});
  }
  return stages;
}

bool Machine::has_ended() const {
  return pipeline_.sensor.done && (!matcher_ || pipeline_.matcher.done) && (!filter_ || pipeline_.filter.done);
}

int Machine::scheduling_error() const {
  for (const RealTimeThread* const thread : {&sensor_thread_, &matcher_thread_, &filter_thread_}) {
    if (const int error = thread->scheduling_error() != 0 ? thread->scheduling_error() : thread->affinity_error();
        thread->started() && error != 0) {
      return error;
    }
  }
  return 0;
}

DaemonResult Machine::result(bool is_last) {
  DaemonResult result;
  result.cloud_format = cloud_format_;
  result.laser = laser_;
  result.has_trajectory = publisher_.keeps_poses();
  if (is_last && filter_) {
    take_last(result);
  } else {
    const auto as_graph = publisher_.write_world(false, result.map);
    result.map = as_graph || !filter_ ? std::move(result.map) : publisher_.map();
    result.trajectory = publisher_.poses(as_graph.value_or(take_online));
    result.cloud = cloud_format_ != CloudFormat::kNone ? publisher_.cloud() : result.cloud;
  }
  result.online_trajectory = publisher_.poses(take_online);
  result.health = publisher_.health();
  result.cpu = publisher_.cpu();
  result.wall_s = static_cast<double>(clock_.now_ns() - start_ns_) * 1e-9;
  return result;
}

void Machine::take_last(DaemonResult& result) {
  std::vector<StampedPose> path;
  filter_->filter().finish();
  filter_->filter().write_path(path);
  const auto as_graph = publisher_.write_world(true, result.map);
  if (!as_graph) {
    filter_->filter().write_occupancy(result.map);
  }
  const PoseStream::Change change = as_graph ? *as_graph : take_final(path);
  result.trajectory = publisher_.poses(change);
  if (cloud_format_ != CloudFormat::kNone) {
    if (as_graph) {
      move_to(publisher_.poses(change), path);
    }
    result.cloud = publisher_.final_cloud(path);
  }
}

}  // namespace odoless
