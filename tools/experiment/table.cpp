#include "tools/experiment/table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "core/base/check.hpp"
#include "tools/command/error.hpp"

namespace odoless {

namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(separator), text.size());
    parts.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

}  // namespace

std::string format_csv(const Table& table) {
  std::string text = fmt::format("{}\n", fmt::join(table.columns, ","));
  for (const std::vector<double>& row : table.rows) {
    ODOLESS_CHECK(row.size() == table.columns.size());
    text += fmt::format("{:.9g}\n", fmt::join(row, ","));
  }
  return text;
}

Table parse_csv(const std::string& name, const std::string& text) {
  Table table{name, {}, {}};
  int line_number = 0;
  for (const std::string_view line : split(text, '\n')) {
    const std::vector<std::string_view> fields = split(line, ',');
    if (++line_number == 1) {
      table.columns.assign(fields.begin(), fields.end());
      continue;
    }
    std::vector<double>& row = table.rows.emplace_back(fields.size());
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const auto [end, error] = std::from_chars(fields[i].data(), fields[i].data() + fields[i].size(), row[i]);
      if (error != std::errc() || end != fields[i].data() + fields[i].size() || fields.size() != table.columns.size()) {
        throw DataError(name + ".csv", line_number, "not a row of its header's numbers", "what format_csv writes");
      }
    }
  }
  return table;
}

}  // namespace odoless
