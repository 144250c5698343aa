#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>

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

 private:
  std::int64_t wall_start_ns_;
  std::int64_t cpu_start_ns_;
};

/// Figures that every job over a log has: scans, log_duration_s, wall_s, cpu_s, realtime_factor, peak_rss_bytes,
/// match_median_us, match_p99_us, match_max_us, poor_matches.
[[nodiscard]] nlohmann::ordered_json summarise(std::span<const MatchRow> matches, std::int64_t scans,
                                               double log_duration_s, const ResourceMeter& meter);

}  // namespace odoless
