#pragma once

#include <string>
#include <string_view>

namespace odoless {

/// How one unit of the code appears in files: radians as degrees, nanoseconds as milliseconds, all others as they are.
struct FileUnit {
  std::string_view inside_suffix;  ///< end of the member's name, with its underscore
  std::string_view file_suffix;    ///< end of the key in the file
  double numerator;                ///< a number of the file times numerator / denominator is the number inside
  double denominator;
};

/// The unit that a member's name ends in.
[[nodiscard]] const FileUnit& file_unit(std::string_view member);

/// A member's name as files spell it: search_yaw_rad is search_yaw_deg.
[[nodiscard]] std::string key_in_file(std::string_view member);

/// A number of the file in the unit of the code.
[[nodiscard]] double from_file(const FileUnit& unit, double value);

/// The shortest number that `from_file` takes to `value`; where none does exactly, the nearest.
[[nodiscard]] double to_file(const FileUnit& unit, double value);

/// The unit of a key as people write it (m/s for speed_mps), or nothing for a plain number.
[[nodiscard]] std::string_view unit_symbol(std::string_view key);

}  // namespace odoless
