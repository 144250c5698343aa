#include "tools/experiment/table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/check.hpp"

namespace odoless {

std::string format_csv(const Table& table) {
  std::string text = fmt::format("{}\n", fmt::join(table.columns, ","));
  for (const std::vector<double>& row : table.rows) {
    ODOLESS_CHECK(row.size() == table.columns.size());
    text += fmt::format("{:.9g}\n", fmt::join(row, ","));
  }
  return text;
}

}  // namespace odoless
