#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <variant>
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

/// Of numbers only: the words behind the last _ of another key are no unit.
std::string_view unit_of(const Entry& entry) {
  const Entry::Value value = entry.get();
  const bool number = std::holds_alternative<double>(value) || std::holds_alternative<std::int64_t>(value);
  return number ? unit_symbol(entry.key) : std::string_view{};
}

std::string comment_of(const Entry& entry) {
  const std::string range = range_text(entry);
  const std::string_view unit = unit_of(entry);
  return fmt::format("# {}{}{}{}{}\n", entry.text, range.empty() ? "" : " Range: ", range, unit.empty() ? "" : " ",
                     unit);
}

/// A file of these entries, table by table.
std::string write_file(std::span<const Entry> entries, std::string (*text_of)(const Entry&)) {
  std::string out;
  for (const std::string_view table : tables_of(entries)) {
    if (!table.empty()) {
      fmt::format_to(std::back_inserter(out), "{}[{}]\n", out.empty() ? "" : "\n", table);
    }
    for (const Entry& entry : entries) {
      if (table_of(entry.key) == table) {
        out += comment_of(entry) + text_of(entry);
      }
    }
  }
  return out;
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
  return write_file(entries, [](const Entry& entry) {
    return fmt::format("{} = {}\n", name_of(entry.key), value_text(entry.get()));
  });
}

std::string entries_to_template(std::span<const Entry> entries, std::span<const std::string_view> keys) {
  std::vector<Entry> wanted;
  std::copy_if(entries.begin(), entries.end(), std::back_inserter(wanted),
               [&](const Entry& entry) { return std::find(keys.begin(), keys.end(), entry.key) != keys.end(); });
  return write_file(wanted, [](const Entry& entry) {
    return fmt::format("#{} = {}\n", name_of(entry.key), short_text(entry.get()));
  });
}

std::string entries_to_reference(std::span<const Entry> entries) {
  std::string out = "| key | type | default | range | unit | meaning |\n|---|---|---|---|---|---|\n";
  for (const Entry& entry : entries) {
    fmt::format_to(std::back_inserter(out), "| `{}` | {} | {} | {} | {} | {} |\n", entry.key, kind_name(entry),
                   short_text(entry.get()), range_text(entry), unit_of(entry), escape_markdown(entry.text));
  }
  return out;
}

}  // namespace odoless
