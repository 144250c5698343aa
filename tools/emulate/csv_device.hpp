#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "tools/emulate/emulated_lrf.hpp"

namespace odoless {

/// A laser of one's own, that sends a line of text per turn (drivers/lrf/csv) from the moment that it has power,
/// whoever listens, and takes no commands: 360 beams over 270 deg, 20 times a second, up to 15 m.
class CsvDevice final : public EmulatedLrf {
 public:
  static constexpr std::string_view kName = "csv";
  static constexpr std::string_view kProduct = "laser of one's own, lines of text";
  static constexpr std::int64_t kTurnNs = 50'000'000;
  static constexpr double kRangeSdM = 0.01;

  /// `source` must outlive it.
  CsvDevice(EmulatedScans& source, EmulatedLrfOptions options, std::int64_t now_ns);

 private:
  void hear(std::string_view /*bytes*/, std::int64_t /*now_ns*/) override {}
  [[nodiscard]] std::int64_t due_ns(std::int64_t piece) const override;
  void on_due(std::int64_t piece) override;
  void restart(std::int64_t now_ns) override { switched_on_ns_ = now_ns; }

  std::int64_t switched_on_ns_;
  std::vector<EmulatedBeam> beams_;
  std::vector<double> ranges_m_;
};

}  // namespace odoless
