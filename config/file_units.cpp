#include "config/file_units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace odoless {
namespace {

constexpr std::array<FileUnit, 5> kUnits{{
    {"_rad", "_deg", std::numbers::pi, 180.0},
    {"_radps", "_degps", std::numbers::pi, 180.0},
    {"_radps2", "_degps2", std::numbers::pi, 180.0},
    {"_ns", "_ms", 1e6, 1.0},
    {"", "", 1.0, 1.0},
}};

using Symbol = std::pair<std::string_view, std::string_view>;
constexpr std::array<Symbol, 29> kSymbols{{
    {"_m_per_sqrt_m", "m/√m"},
    {"_rad_per_sqrt_m", "rad/√m"},
    {"_rad_per_sqrt_deg", "rad/√deg"},
    {"_1_m2", "1/m²"},
    {"_degps2", "deg/s²"},
    {"_per_m", "1/m"},
    {"_per_deg", "1/deg"},
    {"_per_s", "1/s"},
    {"_mps", "m/s"},
    {"_degps", "deg/s"},
    {"_mps2", "m/s²"},
    {"_m2", "m²"},
    {"_m", "m"},
    {"_mm", "mm"},
    {"_deg2", "deg²"},
    {"_deg", "deg"},
    {"_ms", "ms"},
    {"_us", "µs"},
    {"_s", "s"},
    {"_hz", "Hz"},
    {"_cells", "cells"},
    {"_bytes", "bytes"},
    {"_mb", "MB"},
    {"_px", "px"},
    {"_percent", "%"},
    {"_rad2", "rad²"},
    {"_beams", "beams"},
    {"_degrees", "degrees"},
    {"_v", "V"},
}};

}  // namespace

const FileUnit& file_unit(std::string_view member) {
  return *std::find_if(kUnits.begin(), kUnits.end() - 1,
                       [&](const FileUnit& unit) { return member.ends_with(unit.inside_suffix); });
}

std::string key_in_file(std::string_view member) {
  const FileUnit& unit = file_unit(member);
  return fmt::format("{}{}", member.substr(0, member.size() - unit.inside_suffix.size()), unit.file_suffix);
}

double from_file(const FileUnit& unit, double value) { return value * unit.numerator / unit.denominator; }

double to_file(const FileUnit& unit, double value) {
  if (value == 0.0 || unit.numerator == unit.denominator) {
    return value;
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double nearest = value * unit.denominator / unit.numerator;
  double best = nearest;
  auto best_length = std::numeric_limits<std::size_t>::max();
  // Two roundings lie between a number and its way there and back, so the one sought is at most two steps away.
  double candidate = std::nextafter(std::nextafter(nearest, -kInfinity), -kInfinity);
  for (int step = 0; step < 5; ++step) {
    const std::size_t length = fmt::format("{}", candidate).size();
    if (from_file(unit, candidate) == value && length < best_length) {
      best = candidate;
      best_length = length;
    }
    candidate = std::nextafter(candidate, kInfinity);
  }
  return best;
}

std::string_view unit_symbol(std::string_view key) {
  const auto* const found =
      std::find_if(kSymbols.begin(), kSymbols.end(), [&](const Symbol& symbol) { return key.ends_with(symbol.first); });
  return found == kSymbols.end() ? std::string_view{} : found->second;
}

}  // namespace odoless
