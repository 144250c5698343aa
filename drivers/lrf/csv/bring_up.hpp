#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "drivers/lrf/bring_up_steps.hpp"
#include "drivers/lrf/csv/scan_stream.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"

namespace odoless::csv {

enum class Step : std::uint8_t { kListen, kDone };

/// Listens until two lines in a row have one shape. Nothing is sent.
/// Thread: one thread. Real time: no allocation.
class BringUp final : public BringUpSteps<ScanStream, Step> {
 public:
  BringUp(const LrfParams& params, ScanStream& stream);

  void start(std::int64_t now_ns, bool with_reset);
  void on_line(std::string_view line, std::int64_t now_ns, LrfSink& sink);
  void on_deadline(std::int64_t now_ns, LrfSink& sink);
  [[nodiscard]] int line_baud() const { return params().baud; }

 private:
  struct Heard {
    ScanLine line;
    std::int64_t arrival_ns = 0;
  };

  int refused_ = 0;            ///< lines, in this outage
  std::optional<Heard> last_;  ///< line
};

}  // namespace odoless::csv
