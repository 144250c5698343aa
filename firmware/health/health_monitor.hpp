#pragma once

#include <cstdint>
#include <optional>

#include "core/base/parameters.hpp"
#include "firmware/pipeline/messages.hpp"
#include "firmware/records/health.hpp"

namespace odoless {

/// From when on something counts as wrong.
struct HealthParams {
  double silent_periods = 1.75;
  std::int64_t fault_after_ns = 1'000'000'000;
  int poor_matches = 3;
  double weak_information_1_m2 = 15.0;
  std::int64_t deadline_memory_ns = 5'000'000'000;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("silent_periods", self.silent_periods, Range{1.1, 100.0},
                "Time without a scan, in scan periods, after which the laser counts as silent.");
    visit.value("fault_after_ns", self.fault_after_ns, Range<std::int64_t>{10'000'000, 60'000'000'000},
                "Time without a scan after which the state is FAULT and the pose must not be used.");
    visit.value("poor_matches", self.poor_matches, Range{1, 1000},
                "Number of rejected or ambiguous matches in a row after which health reports them.");
    visit.value("weak_information_1_m2", self.weak_information_1_m2, Range{0.0, 1e6},
                "Curvature of the fitness along a direction below which the scene counts as degenerate: that direction "
                "is unconstrained.");
    visit.value("deadline_memory_ns", self.deadline_memory_ns, Range<std::int64_t>{0, 600'000'000'000},
                "Time for which health reports a missed deadline, a dropped scan or a refused record.");
  }
};

/// What is known besides the stages' own reports.
struct Surroundings {
  std::uint32_t standing_reasons = 0;  ///< that hold for the whole run: kReasonNotRealTime
  bool device_tried = false;           ///< opening the device failed, or the line was lost
  bool stage_silent = false;
  bool stopped = false;    ///< the emergency stop
  bool gpio_lost = false;  ///< a line of GPIO, or the sync pulse
  std::int32_t scan_queue_high_water = 0;
  std::int32_t motion_queue_high_water = 0;
  std::int64_t records_dropped = 0;
  std::int64_t publish_errors = 0;
  std::int32_t save_error = 0;     ///< errno of the last save
  std::int32_t storage_error = 0;  ///< of all that is written
  double checkpoint_age_s = -1.0;
  std::optional<CloudHealth> cloud{};
  std::optional<GraphHealth> graph{};
  std::optional<WorldHealth> world{};
};

/// Makes the health report of what the stages say: the state, its reasons, and every figure.
///
/// Pure: time comes in as stamps. Thread: publisher thread.
class HealthMonitor {
 public:
  explicit HealthMonitor(const HealthParams& params) : params_(params) {}

  [[nodiscard]] const HealthReport& update(const SensorReport& sensor, const MatcherReport& matcher,
                                           const FilterReport& filter, const Surroundings& surroundings,
                                           std::int64_t now_ns);
  void set_params(const HealthParams& params) { params_ = params; }

 private:
  /// A count that grew lately.
  class Growth {
   public:
    [[nodiscard]] bool update(std::int64_t count, std::int64_t now_ns, std::int64_t memory_ns);

   private:
    std::int64_t count_ = 0;
    std::int64_t grew_at_ns_ = INT64_MIN;
  };

  [[nodiscard]] std::uint32_t sensor_reasons(const SensorReport& sensor, const Surroundings& surroundings,
                                             std::int64_t now_ns);
  [[nodiscard]] std::uint32_t estimate_reasons(const MatcherReport& matcher, const FilterReport& filter,
                                               std::int64_t now_ns);
  [[nodiscard]] std::uint32_t load_reasons(const HealthReport& report, std::int64_t now_ns);
  [[nodiscard]] HealthState state_of(const SensorReport& sensor, const FilterReport& filter,
                                     WorldPlaceKnown place) const;
  void copy_figures(const SensorReport& sensor, const MatcherReport& matcher, const FilterReport& filter,
                    const Surroundings& surroundings, std::int64_t now_ns);

  HealthParams params_;
  HealthReport report_;
  std::int64_t began_ns_ = 0;  ///< 0: not yet
  Growth rejected_;
  Growth motions_refused_;
  Growth not_authentic_;
  Growth tilt_refused_;
  Growth dropped_;
  Growth missed_;
  Growth map_refused_;
  Growth unpublished_;
  Growth lost_datagrams_;
  Growth cloud_refused_;
  Growth level_scans_;
};

}  // namespace odoless
