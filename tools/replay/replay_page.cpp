#include "tools/replay/replay_page.hpp"

#include <fmt/core.h>
#include <sysexits.h>
#include <unistd.h>

#include <cstdio>

#include "firmware/health/health_monitor.hpp"
#include "firmware/publisher/map_store.hpp"
#include "firmware/stages/stage_reports.hpp"
#include "firmware/threads/tile_sweep.hpp"
#include "firmware/web/web_server.hpp"
#include "tools/command/error.hpp"

namespace odoless {
namespace {

constexpr std::size_t kOutbox_bytes = std::size_t{1} << 20;
constexpr double kMapRefresh_s = 5.0;  // of recorded time

}  // namespace

/// What a daemon has of all this, but for its threads.
struct ReplayPage::Parts {
  Parts(const WebParams& params, FilterStage& stage)
      : map(stage.geometry()), view(stage.geometry()), tiles(stage, kMapRefresh_s), server(params, view) {}

  MapStore map;
  LiveView view;
  Outbox outbox{kOutbox_bytes};
  TileSweep tiles;
  HealthMonitor monitor{HealthParams{}};
  SensorReport sensor;
  MatcherReport matcher;
  FilterReport filter;
  WebServer server;
};

ReplayPage::ReplayPage(const std::string& listen) {
  params_.listen = listen;
  if (const std::string wrong = params_.contradiction(); !wrong.empty()) {
    throw UsageError("--web: " + wrong);
  }
}

ReplayPage::~ReplayPage() = default;

ReplayWatcher ReplayPage::watcher() {
  return [this](const ChainStep& step, const RawScan& raw, StageChain& chain) { show(step, raw, chain); };
}

void ReplayPage::begin(FilterStage& stage) {
  parts_ = std::make_unique<Parts>(params_, stage);
  if (const std::string wrong = parts_->server.open(); !wrong.empty()) {
    throw UserError(EX_UNAVAILABLE, "--web: " + wrong);
  }
  if (const int error = parts_->server.start(); error != 0) {
    throw UserError(EX_OSERR, "--web: a thread cannot be made: " + system_reason(error));
  }
  fmt::print(stderr, "odoless: page: http://{}/\n", params_.listen);
}

void ReplayPage::show(const ChainStep& step, const RawScan& raw, StageChain& chain) {
  FilterStage& stage = chain.filter();
  if (!parts_) {
    begin(stage);
  }
  const PoseEstimate estimate = stage.filter().estimate();
  ranges_m_.assign(raw.ranges_m.begin(), raw.ranges_m.end());
  chain.sensor().mask(raw, ranges_m_);
  const PoseRecord pose = pose_record_of(step.filter, estimate, stage, step.stamp_ns);
  parts_->view.take(pose);
  parts_->view.take(pose,
                    {.stamp_ns = raw.stamp_ns,
                     .start_angle_rad = raw.start_angle_rad,
                     .angle_step_rad = raw.angle_step_rad,
                     .beams = static_cast<std::int32_t>(raw.ranges_m.size())},
                    ranges_m_);
  parts_->tiles.send(parts_->outbox, step.filter, step.stamp_ns, step.motion.to_stamp_ns - step.motion.from_stamp_ns);
  RecordRing& records = parts_->outbox.ring();
  while (const auto record = records.front()) {
    const auto cells = elements_of<std::uint8_t, MapTileRecord>(record->bytes);
    parts_->map.update(record_of<MapTileRecord>(record->bytes), cells);
    parts_->view.take(record_of<MapTileRecord>(record->bytes), cells);
    records.pop();
  }
  parts_->sensor.open = true;
  parts_->sensor.last_scan_ns = raw.stamp_ns;
  enter(chain.sensor(), parts_->sensor);
  ++parts_->matcher.stage.scans;
  ++parts_->filter.stage.scans;
  enter(step.motion, parts_->matcher);
  enter(step.filter, estimate, stage, parts_->filter);
  const HealthReport& health =
      parts_->monitor.update(parts_->sensor, parts_->matcher, parts_->filter, {}, raw.stamp_ns);
  parts_->view.take({health, pose, parts_->map.size(), health.lrf.rate_hz});  // each scan has a pose
}

void ReplayPage::stay() {
  static_cast<void>(std::fflush(stdout));
  fmt::print(stderr, "odoless: the page stays until this is interrupted (Ctrl-C)\n");
  while (true) {
    ::pause();
  }
}

}  // namespace odoless
