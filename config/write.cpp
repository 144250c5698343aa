#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "config/expectation.hpp"

namespace odoless {
namespace {

/// The tables that the entries stand in, each once. The file's top is first, since nothing can return to it.
std::vector<std::string_view> tables_of(std::span<const Entry> entries) {
  std::vector<std::string_view> tables{""};
  for (const Entry& entry : entries) {
    if (std::find(tables.begin(), tables.end(), table_of(entry.key)) == tables.end()) {
      tables.push_back(table_of(entry.key));
    }
  }
  return tables;
}

void append_entry(const Entry& entry, std::string& out) {
  const std::string range = range_text(entry);
  fmt::format_to(std::back_inserter(out), "# {}{}{}\n{} = {}\n", entry.text, range.empty() ? "" : " Range: ", range,
                 name_of(entry.key), value_text(entry.get()));
}

std::string escape_markdown(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    escaped += c == '|' ? "\\|" : std::string(1, c);
  }
  return escaped;
}

}  // namespace

std::string entries_to_toml(std::span<const Entry> entries) {
  std::string out;
  for (const std::string_view table : tables_of(entries)) {
    if (!table.empty()) {
      fmt::format_to(std::back_inserter(out), "{}[{}]\n", out.empty() ? "" : "\n", table);
    }
    for (const Entry& entry : entries) {
      if (table_of(entry.key) == table) {
        append_entry(entry, out);
      }
    }
  }
  return out;
}

std::string entries_to_reference(std::span<const Entry> entries) {
  std::string out = "| key | type | default | range | unit | meaning |\n|---|---|---|---|---|---|\n";
  for (const Entry& entry : entries) {
    fmt::format_to(std::back_inserter(out), "| `{}` | {} | {} | {} | {} | {} |\n", entry.key, kind_name(entry),
                   value_text(entry.get()), range_text(entry), unit_symbol(entry.key), escape_markdown(entry.text));
  }
  return out;
}

}  // namespace odoless
