#pragma once

#include <optional>
#include <string_view>

namespace odoless {

/// Which stages run in this process. The others run in another one, and the two talk over LCM.
enum class StageSet {
  kAll,            ///< sensor,matcher,filter
  kSensorMatcher,  ///< on the robot: publishes scans and motions
  kFilter,         ///< elsewhere: takes them
};

inline constexpr const char* kStageSets = "sensor,matcher,filter or sensor,matcher or filter";

[[nodiscard]] inline std::optional<StageSet> parse_stages(std::string_view text) {
  if (text == "sensor,matcher,filter") {
    return StageSet::kAll;
  }
  if (text == "sensor,matcher") {
    return StageSet::kSensorMatcher;
  }
  if (text == "filter") {
    return StageSet::kFilter;
  }
  return std::nullopt;
}

[[nodiscard]] inline bool has_matcher(StageSet stages) { return stages != StageSet::kFilter; }
[[nodiscard]] inline bool has_filter(StageSet stages) { return stages != StageSet::kSensorMatcher; }

}  // namespace odoless
