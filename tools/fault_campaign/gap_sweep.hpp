#pragma once

#include <span>
#include <vector>

#include "tools/fault_campaign/run.hpp"

namespace odoless::campaign {

/// A run of the gap sweep and what became of it.
struct GapResult {
  RunResult run{};
  double error_before_m = 0.0;     ///< of the last pose before the gap
  double known_share = 0.0;        ///< of the first scan after the gap: beams that end where the map has something
  double known_later_share = 0.0;  ///< the least of that within 10 s after the gap

  static constexpr double kKnown = 0.8;  ///< from that share on the map knows the place
  [[nodiscard]] bool is_known() const { return known_share >= kKnown; }
  /// Also where the robot comes in the next 10 s.
  [[nodiscard]] bool stays_known() const { return is_known() && known_later_share >= kKnown; }
};

/// Scans that are missing while the robot drives on: two worlds, twelve times, eight lengths.
class GapSweep {
 public:
  explicit GapSweep(std::uint64_t campaign_seed);

  static constexpr int kLengths = 8;
  static constexpr int kTimes = 12;
  [[nodiscard]] std::span<const Scenario> scenarios() const { return scenarios_; }
  /// How many groups there are: runs that are the same up to the gap, which are played at once.
  [[nodiscard]] int groups() const { return static_cast<int>(scenarios_.size()) / kLengths; }
  [[nodiscard]] std::span<const Scenario> group(int index) const {
    return scenarios().subspan(static_cast<std::size_t>(index) * kLengths, kLengths);
  }

 private:
  std::vector<Scenario> scenarios_;
};

/// Plays runs that differ in the gap's length alone. @param trace  Of the last of them; may be null.
[[nodiscard]] std::vector<GapResult> play_gaps(std::span<const Scenario> scenarios, Trace* trace = nullptr);

}  // namespace odoless::campaign
