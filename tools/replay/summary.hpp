#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "tools/output/matches.hpp"

namespace odoless {

/// What a job took, from its construction on.
class ResourceMeter {
 public:
  ResourceMeter();
  [[nodiscard]] double wall_s() const;
  [[nodiscard]] double cpu_s() const;
  /// Of the whole process until now.
  [[nodiscard]] static std::int64_t peak_rss_bytes();
  /// Of the process now; 0 where /proc does not say.
  [[nodiscard]] static std::int64_t rss_bytes();

 private:
  std::int64_t wall_start_ns_;
  std::int64_t cpu_start_ns_;
};

/// Mean of each tenth of the values, in their order; fewer where there are fewer values.
[[nodiscard]] std::vector<double> mean_by_tenth(std::span<const double> values);

/// Figures that every job over a log has: scans, log_duration_s, wall_s, cpu_s, realtime_factor, peak_rss_bytes,
/// match_median_us, match_p99_us, match_max_us, poor_matches.
[[nodiscard]] nlohmann::ordered_json summarise(std::span<const MatchRow> matches, std::int64_t scans,
                                               double log_duration_s, const ResourceMeter& meter);

}  // namespace odoless
