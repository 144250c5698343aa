#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace odoless {

/// Closed range of a numeric parameter.
template <class T>
struct Range {
  T min;
  T max;
};
template <class T>
Range(T, T) -> Range<T>;  // clang 14 does not deduce aggregates by itself

/// Longest text of a parameter: a path or an address is shorter.
inline constexpr std::size_t kTextMaxBytes = 1024;

/// Angles counter-clockwise from the first to the second.
struct AngleSector {
  double from_rad = 0.0;
  double to_rad = 0.0;
};

/// Of a parameter that is a list of sectors: how many, and how far from 0 each end.
inline constexpr std::size_t kSectorsMax = 16;
inline constexpr double kSectorEnd_max_rad = 6.283185307179586;

/// Whether a text can be a parameter: one line, not too long. Anything else is a mistake or an attack.
[[nodiscard]] constexpr bool is_parameter_text(std::string_view text) {
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      return false;
    }
  }
  return text.size() <= kTextMaxBytes;
}

/// How parameter structs describe themselves. Each struct `FooParams` keeps its defaults as member initialisers and has
///
///   template <class Self, class Visitor>
///   static void describe(Self& self, Visitor& visit) {
///     visit.value("cell_size_m", self.cell_size_m, Range{0.1, 20.0}, "Side of an NDT cell.");
///     visit.flag("refine", self.refine, "Whether a Newton step ends the search.");
///     visit.choice("strategy", self.strategy, kStrategyNames, "Mutation of Differential Evolution.");
///     visit.text("device", self.device, "Path of the laser's serial port.");
///     visit.sectors("ignore", self.ignore, "Sectors that the robot itself is seen in.");
///     visit.group("grid", self.grid, "The map's grid.");
///   }
///
/// `Self` is the struct or its const form. A value is double, int or std::int64_t; its name ends in its unit.
/// Configuration files show _rad as _deg and _ns as _ms. A choice is an enumeration that counts from 0, with one name
/// per enumerator. A text is a std::string of one line, sectors are a
/// std::vector<AngleSector>, which files show as pairs of degrees. From this one description come the TOML reader and
/// writer, the range checks and the reference page.
template <class Params>
[[nodiscard]] bool parameters_in_range(const Params& params);

namespace detail {

class RangeChecker {
 public:
  template <class T>
  void value(const char*, const T& value, Range<std::type_identity_t<T>> range, const char*) {
    ok_ = ok_ && value >= range.min && value <= range.max;  // false for NaN
  }
  void flag(const char*, const bool&, const char*) {}
  template <class Enum>
  void choice(const char*, const Enum& value, std::span<const char* const> names, const char*) {
    ok_ = ok_ && static_cast<std::size_t>(value) < names.size();
  }
  void text(const char*, std::string_view value, const char*) { ok_ = ok_ && is_parameter_text(value); }
  void sectors(const char*, std::span<const AngleSector> sectors, const char*) {
    ok_ = ok_ && sectors.size() <= kSectorsMax;
    for (const AngleSector& sector : sectors) {
      ok_ = ok_ && is_end(sector.from_rad) && is_end(sector.to_rad);
    }
  }
  template <class Group>
  void group(const char*, const Group& group, const char*) {
    Group::describe(group, *this);
  }
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  static bool is_end(double angle_rad) {  // false for NaN
    return angle_rad >= -kSectorEnd_max_rad && angle_rad <= kSectorEnd_max_rad;
  }

  bool ok_ = true;
};

}  // namespace detail

template <class Params>
bool parameters_in_range(const Params& params) {
  detail::RangeChecker checker;
  Params::describe(params, checker);
  return checker.ok();
}

}  // namespace odoless
