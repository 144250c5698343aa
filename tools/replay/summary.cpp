#include "tools/replay/summary.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <numeric>
#include <vector>

#include "rt/cpu_clock.hpp"

namespace odoless {
namespace {

double quantile(const std::vector<double>& sorted, double fraction) {
  if (sorted.empty()) {
    return 0.0;
  }
  return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(fraction * static_cast<double>(sorted.size())))];
}

}  // namespace

ResourceMeter::ResourceMeter() : wall_start_ns_(monotonic_ns()), cpu_start_ns_(process_cpu_ns()) {}

double ResourceMeter::wall_s() const { return static_cast<double>(monotonic_ns() - wall_start_ns_) * 1e-9; }

double ResourceMeter::cpu_s() const { return static_cast<double>(process_cpu_ns() - cpu_start_ns_) * 1e-9; }

std::int64_t ResourceMeter::peak_rss_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
}

std::int64_t ResourceMeter::rss_bytes() {
  std::int64_t size_pages = 0;
  std::int64_t resident_pages = 0;
  std::ifstream("/proc/self/statm") >> size_pages >> resident_pages;
  return resident_pages * sysconf(_SC_PAGESIZE);
}

std::vector<double> mean_by_tenth(std::span<const double> values) {
  constexpr std::size_t kParts = 10;
  std::vector<double> means;
  for (std::size_t part = 0; part < kParts; ++part) {
    const std::size_t begin = values.size() * part / kParts;
    const std::size_t end = values.size() * (part + 1) / kParts;
    if (begin < end) {
      means.push_back(std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(begin),
                                      values.begin() + static_cast<std::ptrdiff_t>(end), 0.0) /
                      static_cast<double>(end - begin));
    }
  }
  return means;
}

nlohmann::ordered_json summarise(std::span<const MatchRow> matches, std::int64_t scans, double log_duration_s,
                                 const ResourceMeter& meter) {
  std::vector<double> times_us;
  for (const MatchRow& row : matches) {
    times_us.push_back(row.time_us);
  }
  std::sort(times_us.begin(), times_us.end());
  const double wall_s = meter.wall_s();
  return {
      {"scans", scans},
      {"log_duration_s", log_duration_s},
      {"wall_s", wall_s},
      {"cpu_s", meter.cpu_s()},
      {"realtime_factor", wall_s > 0.0 ? log_duration_s / wall_s : 0.0},
      {"peak_rss_bytes", ResourceMeter::peak_rss_bytes()},
      {"match_median_us", quantile(times_us, 0.5)},
      {"match_p99_us", quantile(times_us, 0.99)},
      {"match_max_us", times_us.empty() ? 0.0 : times_us.back()},
      {"poor_matches", std::count_if(matches.begin(), matches.end(), [](const MatchRow& r) { return !r.converged; })}};
}

}  // namespace odoless
