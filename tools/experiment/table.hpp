#pragma once

#include <string>
#include <vector>

namespace odoless {

/// Numbers of an experiment, for other programs.
struct Table {
  std::string name;                  ///< the file's, without .csv
  std::vector<std::string> columns;  ///< with units
  std::vector<std::vector<double>> rows;
};

/// Comma-separated: a header, then a line per row; 9 significant digits.
[[nodiscard]] std::string format_csv(const Table& table);
/// Reads that back. @throws DataError where a row has other fields than the header.
[[nodiscard]] Table parse_csv(const std::string& name, const std::string& text);

}  // namespace odoless
