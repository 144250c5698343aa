#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "drivers/lrf/csv/scan_stream.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"

namespace odoless::csv {

/// Listens until two lines in a row have one shape. Nothing is sent.
/// Thread: one thread. Real time: no allocation.
class BringUp {
 public:
  BringUp(const LrfParams& params, ScanStream& stream);

  void start(std::int64_t now_ns, bool with_reset);
  [[nodiscard]] bool done() const { return is_done_; }
  void on_line(std::string_view line, std::int64_t now_ns, LrfSink& sink);
  void on_deadline(std::int64_t now_ns, LrfSink& sink);
  [[nodiscard]] std::int64_t deadline_ns() const { return deadline_ns_; }

  [[nodiscard]] int line_baud() const { return line_baud_; }
  /// The sender never says that something is wrong with it.
  [[nodiscard]] static std::uint64_t device_errors() { return 0; }

 private:
  struct Heard {
    ScanLine line;
    std::int64_t arrival_ns = 0;
  };

  ScanStream& stream_;
  int line_baud_;
  bool is_done_ = false;
  bool silence_told_ = false;
  int refused_ = 0;            ///< lines, in this outage
  std::optional<Heard> last_;  ///< line
  std::int64_t deadline_ns_ = 0;
};

}  // namespace odoless::csv
