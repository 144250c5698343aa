#include "tools/experiment/path_claims.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/experiment/measures.hpp"

namespace odoless {
namespace {

constexpr double kSeedErrorMaxM = 0.3;

double max_of(std::span<const double> errors_m) {
  return errors_m.empty() ? 0.0 : *std::max_element(errors_m.begin(), errors_m.end());
}

double median_of(std::span<const double> errors_m) { return quantile({errors_m.begin(), errors_m.end()}, 0.5); }

std::string in_whole_mm(double error_m) { return fmt::format("{:.0f} mm", error_m * 1e3); }

}  // namespace

Claim error_accumulates(std::span<const double> errors_m) {
  const std::size_t third = errors_m.size() / 3;
  const double first_m = max_of(errors_m.first(third));
  const double last_m = max_of(errors_m.last(third));
  return {"5.7", "by scan matching alone the error inevitably grows with the poses",
          fmt::format("largest error of the first third {}, of the last {}; at the end {}", in_whole_mm(first_m),
                      in_whole_mm(last_m), in_whole_mm(errors_m.empty() ? 0.0 : errors_m.back())),
          last_m > first_m};
}

Claim error_is_mostly_small(std::span<const double> errors_m) {
  constexpr double kMostly = 0.9;
  const auto small = std::count_if(errors_m.begin(), errors_m.end(), [](double e) { return e < kSeedErrorMaxM; });
  const double share = static_cast<double>(small) / static_cast<double>(std::max<std::size_t>(1, errors_m.size()));
  return {"5.25", "with DP-SLAM the error is kept mostly under 300 mm",
          fmt::format("{:.1f} % of {} poses; median {}, largest {}", 100.0 * share, errors_m.size(),
                      in_whole_mm(median_of(errors_m)), in_whole_mm(max_of(errors_m))),
          share >= kMostly};
}

Claim error_does_not_grow(std::span<const double> errors_m) {
  const std::size_t third = errors_m.size() / 3;
  const double first_m = median_of(errors_m.first(third));
  const double last_m = median_of(errors_m.last(third));
  return {"5.25", "with DP-SLAM the error does not increase with time",
          fmt::format("median error of the first third {}, of the last {}", in_whole_mm(first_m), in_whole_mm(last_m)),
          last_m <= std::max(2.0 * first_m, kSeedErrorMaxM / 2.0)};
}

Claim error_is_tiny(std::span<const double> errors_m) {
  constexpr double kAimM = 0.1;
  return {"5.25", "our aim: never more than 100 mm", fmt::format("largest {}", in_whole_mm(max_of(errors_m))),
          !errors_m.empty() && max_of(errors_m) <= kAimM};
}

Claim filter_beats_matches(std::span<const double> filter_m, std::span<const double> matches_m) {
  return {"5.25", "comparing with Figure 5.7, DP-SLAM keeps the error down",
          fmt::format("largest {} with DP-SLAM, {} by scan matching alone", in_whole_mm(max_of(filter_m)),
                      in_whole_mm(max_of(matches_m))),
          !filter_m.empty() && max_of(filter_m) < max_of(matches_m)};
}

}  // namespace odoless
