#include "tools/replay/replay_page.hpp"

#include <fmt/core.h>
#include <sysexits.h>
#include <unistd.h>

#include <cstdio>

#include "firmware/web/web_server.hpp"
#include "tools/command/error.hpp"
#include "tools/replay/replay_records.hpp"

namespace odoless {
struct ReplayPage::Parts {
  Parts(const WebParams& params, FilterStage& stage) : records(stage), view(stage.geometry()), server(params, view) {}

  ReplayRecords records;
  LiveView view;
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
  if (!parts_) {
    begin(chain.filter());
  }
  LiveView& view = parts_->view;
  ReplayRecords& records = parts_->records;
  records.take(step, raw, chain,
               [&view](const MapTileRecord& tile, std::span<const std::uint8_t> cells) { view.take(tile, cells); });
  view.take(records.pose());
  ranges_m_.assign(raw.ranges_m.begin(), raw.ranges_m.end());
  chain.sensor().mask(raw, ranges_m_);
  view.take(records.pose(), ReplayRecords::scan(raw), ranges_m_);
  const HealthReport& health = records.health();
  view.take({health, records.pose(), records.map().size(), health.lrf.rate_hz});  // each scan has a pose
}

void ReplayPage::stay() {
  static_cast<void>(std::fflush(stdout));
  fmt::print(stderr, "odoless: the page stays until this is interrupted (Ctrl-C)\n");
  while (true) {
    ::pause();
  }
}

}  // namespace odoless
