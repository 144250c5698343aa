#pragma once

#include <memory>
#include <string>
#include <vector>

#include "firmware/web/web_params.hpp"
#include "tools/replay/replay.hpp"

namespace odoless {

/// The daemon's page, of a replay: what the daemon would publish of each scan, as fast as the replay goes.
class ReplayPage {
 public:
  /// @param listen  As web.listen of the daemon. @throws UserError where it cannot be served there.
  explicit ReplayPage(const std::string& listen);
  ~ReplayPage();
  ReplayPage(const ReplayPage&) = delete;
  ReplayPage& operator=(const ReplayPage&) = delete;
  ReplayPage(ReplayPage&&) = delete;
  ReplayPage& operator=(ReplayPage&&) = delete;

  /// What shows each scan; valid as long as the page.
  [[nodiscard]] ReplayWatcher watcher();

  /// Serves what was shown last until the process is interrupted.
  [[noreturn]] void stay();

 private:
  struct Parts;
  void show(const ChainStep& step, const RawScan& raw, StageChain& chain);
  void begin(FilterStage& stage);

  WebParams params_;
  std::unique_ptr<Parts> parts_;  ///< from the first scan on
  std::vector<float> ranges_m_;
};

}  // namespace odoless
