#include "firmware/health/health_text.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr std::array<const char*, 28> kReasonTexts{"no scans",
                                                   "the laser cannot be opened",
                                                   "scans are refused",
                                                   "the laser sees nothing",
                                                   "the laser repeats the same scan",
                                                   "scans do not match each other",
                                                   "degenerate scene: one direction is unconstrained",
                                                   "scans do not match the map",
                                                   "scans or records are dropped, or updates cut short",
                                                   "a deadline was missed",
                                                   "real-time scheduling or locked memory is refused",
                                                   "a file cannot be written",
                                                   "the map is full",
                                                   "LCM messages cannot be sent (is the network up?)",
                                                   "a stage does not answer",
                                                   "datagrams were lost",
                                                   "mapping is paused",
                                                   "emergency stop",
                                                   "a GPIO line or the sync pulse is missing",
                                                   "the tilt servo does not obey",
                                                   "the laser is not level",
                                                   "the 3D map is full",
                                                   "answers of the tilt servo are missing or wrong",
                                                   "motions received over LCM are refused",
                                                   "LCM messages are refused that are not authentic (lcm.key_file)"
                                                   " or not new",
                                                   "the laser sweeps as it was told, and poses come when it is level",
                                                   "it is not sure yet where the robot is in the world of its file",
                                                   "the pose may have drifted: no loop closure holds it"};

}  // namespace

const char* name_of(HealthState state) {
  switch (state) {
    case HealthState::kInit:
      return "INIT";
    case HealthState::kOk:
      return "OK";
    case HealthState::kDegraded:
      return "DEGRADED";
    case HealthState::kLost:
      return "LOST";
    case HealthState::kFault:
      return "FAULT";
  }
  return "?";
}

std::vector<std::string> reasons_of(std::uint32_t reasons) {
  std::vector<std::string> texts;
  for (std::size_t bit = 0; bit < kReasonTexts.size(); ++bit) {
    if ((reasons >> bit & 1U) != 0) {
      texts.emplace_back(kReasonTexts.at(bit));
    }
  }
  return texts;
}

std::string reasons_text(std::uint32_t reasons) { return fmt::format("{}", fmt::join(reasons_of(reasons), ", ")); }

std::string times_text(const ScanTimeFindings& times) {
  std::string text;
  const auto add = [&](std::int64_t count, const std::string& what) {
    text += count > 0 ? fmt::format("{}{}", text.empty() ? "" : ", ", what) : "";
  };
  add(times.out_of_order, fmt::format("{} stamps out of order", times.out_of_order));
  add(times.bunched, fmt::format("{} bunched", times.bunched));
  add(times.gaps, fmt::format("{} gaps of up to {:.1f} s", times.gaps, times.longest_gap_s));
  add(times.clock_sets, fmt::format("clock set {} times", times.clock_sets));
  add(times.doubtful, fmt::format("times of {} scans uncertain", times.doubtful));
  const std::string period =
      times.period_s > 0.0 ? fmt::format("scan period {:.3f} s estimated", times.period_s) : "scan period not known";
  return text.empty() ? period : text + "; " + period;
}

bool is_far(const MapCorrection& correction) {
  constexpr double kFar_m = 0.5;
  constexpr double kFar_rad = 5.0 / 180.0 * std::numbers::pi;
  return math::hypot(correction.moved.x_m, correction.moved.y_m) > kFar_m ||
         std::abs(correction.moved.yaw_rad) > kFar_rad;
}

std::string correction_text(const MapCorrection& correction) {
  const int count = correction.loop_closures;
  const std::string cause =
      correction.cause == CorrectionCause::kFound
          ? fmt::format("the robot was found in the world, at submap {}", correction.reference)
          : fmt::format("{} between submaps {} and {}",
                        count == 1 ? "a loop closure" : fmt::format("{} loop closures, the last one", count),
                        correction.reference, correction.query);
  return fmt::format("the pose is corrected by {:.2f} m and {:.1f} deg: {}",
                     math::hypot(correction.moved.x_m, correction.moved.y_m),
                     std::abs(correction.moved.yaw_rad) * 180.0 / std::numbers::pi, cause);
}

std::string state_sentence(const HealthReport& report) {
  const std::string reasons = reasons_text(report.reasons);
  return reasons.empty() ? std::string(name_of(report.state)) : fmt::format("{}: {}", name_of(report.state), reasons);
}

}  // namespace odoless
