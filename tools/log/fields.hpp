#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tools/log/line_reader.hpp"

namespace odoless {

/// One line of a log split into fields; every accessor throws DataError with file, line and field when the text is not
/// what it should be. Fields are counted from 0 here, from 1 in messages.
class Fields {
 public:
  /// More ranges than a line of the greatest length can hold.
  static constexpr std::size_t kRangesMax = 1'000'000;

  /// Splits the line that `reader` has just given.
  /// @param separator  A space stands for any run of spaces and tabs; any other character separates exactly.
  void split(std::string_view line, const LineReader& reader, char separator = ' ');

  [[nodiscard]] std::size_t size() const { return fields_.size(); }
  [[nodiscard]] std::string_view text(std::size_t index) const { return fields_[index]; }

  /// A finite number. `what` names the field in the message.
  [[nodiscard]] double number(std::size_t index, const char* what) const;
  /// A number that may also be inf or nan.
  [[nodiscard]] float range_m(std::size_t index) const;
  /// A whole number 0 .. max.
  [[nodiscard]] std::size_t count(std::size_t index, std::size_t max, const char* what) const;
  [[nodiscard]] std::int64_t stamp_ns(std::size_t index) const;
  /// The unit of stamps from here on: parse_stamp_ns's digits.
  void set_stamp_digits(int digits) { stamp_digits_ = digits; }
  /// `size` ranges from field `begin` on; they must exist.
  [[nodiscard]] std::vector<float> ranges_m(std::size_t begin, std::size_t size) const;

  /// Throws unless the line has at least `least` fields.
  void require(std::size_t least, const char* layout) const;
  [[noreturn]] void fail(const std::string& wrong, const std::string& right) const;

 private:
  [[noreturn]] void fail_field(std::size_t index, const std::string& right) const;

  std::vector<std::string_view> fields_;
  std::string name_;
  int line_ = 0;
  int stamp_digits_ = 9;
};

}  // namespace odoless
