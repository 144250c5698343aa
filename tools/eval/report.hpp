#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tools/eval/ate.hpp"
#include "tools/eval/pairs.hpp"
#include "tools/eval/relations.hpp"

namespace odoless {

/// A result for people (metres, degrees) and for programs (one object, the unit in each key).
struct Report {
  std::string text;  ///< without a line end
  nlohmann::ordered_json json;
};

[[nodiscard]] Report report(const RelationsResult& result);
[[nodiscard]] Report report(const AteResult& result);
[[nodiscard]] Report report(const PairsResult& result);

[[nodiscard]] constexpr double to_deg(double angle_rad) { return angle_rad * 180.0 / std::numbers::pi; }
[[nodiscard]] constexpr double to_rad(double angle_deg) { return angle_deg * std::numbers::pi / 180.0; }

}  // namespace odoless
