#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "config/config.hpp"
#include "config/expectation.hpp"
#include "config/toml.hpp"

namespace odoless {
namespace {

/// Carries one parsed file into entries, and notes what doesn't fit.
class Loader {
 public:
  Loader(std::string_view source, std::span<const Entry> entries) : source_(source), entries_(entries) {}

  /// `prefix` is the table's key with a dot behind, or empty for the top. It descends into known tables alone, so its
  /// depth is that of the parameters, whatever the file holds.
  void load(const toml::table& table, const std::string& prefix) {
    for (const auto& [name, node] : table) {
      const std::string key = prefix + std::string(name.str());
      if (const Entry* const entry = find_entry(key)) {
        assign(*entry, node);
      } else if (!is_table(key)) {
        report_unknown(key, name.source());
      } else if (const toml::table* const inner = node.as_table()) {
        load(*inner, key + '.');
      } else {
        report(node.source(), fmt::format("key '{}' {}: must be a table, [{}]", key, found_text(node), key));
      }
    }
  }

  [[nodiscard]] std::vector<std::string> take_problems() { return std::move(problems_); }

 private:
  [[nodiscard]] const Entry* find_entry(std::string_view key) const {
    for (const Entry& entry : entries_) {
      if (entry.key == key) {
        return &entry;
      }
    }
    return nullptr;
  }

  [[nodiscard]] bool is_table(std::string_view key) const {
    return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
      return entry.key.size() > key.size() && entry.key.starts_with(key) && entry.key[key.size()] == '.';
    });
  }

  void assign(const Entry& entry, const toml::node& node) {
    const std::optional<Entry::Value> value = read(entry, node);
    if (!value || !in_range(entry, *value)) {
      report(node.source(), fmt::format("key '{}' {}: must be {}", entry.key, found_text(node), expectation(entry)));
    } else if (*value != entry.get()) {  // an equal one stays, and so do those digits that the file's unit doesn't show
      entry.set(*value);
    }
  }

  /// The node as the entry's kind of value, if it is one.
  static std::optional<Entry::Value> read(const Entry& entry, const toml::node& node) {
    const Entry::Value kind = entry.get();
    if (std::holds_alternative<double>(kind) && node.is_number()) {
      return node.is_integer() ? static_cast<double>(node.as_integer()->get()) : node.as_floating_point()->get();
    }
    if (std::holds_alternative<std::int64_t>(kind) && node.is_integer()) {
      return node.as_integer()->get();
    }
    if (std::holds_alternative<bool>(kind) && node.is_boolean()) {
      return node.as_boolean()->get();
    }
    if (std::holds_alternative<Entry::Sectors>(kind) && node.is_array()) {
      return read_sectors(*node.as_array());
    }
    if (std::holds_alternative<std::string>(kind) && node.is_string()) {
      return node.as_string()->get();
    }
    return std::nullopt;
  }

  /// Pairs of numbers; nothing where it is anything else.
  static std::optional<Entry::Value> read_sectors(const toml::array& array) {
    Entry::Sectors sectors;
    for (const toml::node& node : array) {
      const toml::array* const pair = node.as_array();
      if (pair == nullptr || pair->size() != 2 || !(*pair)[0].is_number() || !(*pair)[1].is_number()) {
        return std::nullopt;
      }
      sectors.push_back({(*pair)[0].value_or(0.0), (*pair)[1].value_or(0.0)});
    }
    return sectors;
  }

  static bool are_sectors(const Entry::Sectors& sectors) {
    constexpr double kEnd_max_deg = 360.0;
    const auto is_end = [](double angle_deg) { return std::abs(angle_deg) <= kEnd_max_deg; };  // false for NaN
    return sectors.size() <= kSectorsMax && std::all_of(sectors.begin(), sectors.end(), [&](const auto& sector) {
             return is_end(sector[0]) && is_end(sector[1]);
           });
  }

  static bool in_range(const Entry& entry, const Entry::Value& value) {
    if (const auto* const sectors = std::get_if<Entry::Sectors>(&value)) {
      return are_sectors(*sectors);
    }
    if (const auto* const name = std::get_if<std::string>(&value)) {
      return entry.names.empty() ? is_parameter_text(*name)
                                 : std::find(entry.names.begin(), entry.names.end(), *name) != entry.names.end();
    }
    // Both comparisons are false for NaN, and infinity is beyond every range.
    return std::holds_alternative<bool>(value) || (value >= entry.min && value <= entry.max);
  }

  /// What stands in the file: its value if that is short, else its kind.
  static std::string found_text(const toml::node& node) {
    constexpr std::size_t kLongest = 60;
    std::ostringstream text;
    if (node.is_value()) {
      node.visit([&](const auto& value) {
        if constexpr (toml::is_value<decltype(value)>) {
          text << toml::toml_formatter(value);
        }
      });
    }
    const std::string shown = std::move(text).str();
    if (shown.empty() || shown.size() > kLongest || shown.find('\n') != std::string::npos) {
      std::ostringstream kind;
      kind << node.type();
      return fmt::format("is of type {}", std::move(kind).str());
    }
    return fmt::format("= {}", shown);
  }

  void report_unknown(std::string_view key, const toml::source_region& where) {
    constexpr std::size_t kLongest = 100;
    const std::string_view nearest = nearest_key(key, entries_);
    const std::string advice = nearest.empty() ? "not a parameter" : fmt::format("did you mean '{}'?", nearest);
    report(where, fmt::format("unknown key '{}': {}", key.substr(0, kLongest), advice));
  }

  void report(const toml::source_region& where, std::string_view problem) {
    problems_.push_back(fmt::format("{}:{}: {}", source_, where.begin.line, problem));
  }

  std::string_view source_;
  std::span<const Entry> entries_;
  std::vector<std::string> problems_;
};

toml::table parse(std::string_view text, std::string_view source) {
  try {
    return toml::parse(text, source);
  } catch (const toml::parse_error& error) {
    const toml::source_position where = error.source().begin;
    throw ConfigError({fmt::format("{}:{}:{}: {}", source, where.line, where.column, error.description())});
  }
}

}  // namespace

std::string read_config(const std::filesystem::path& path) {
  constexpr std::streamsize kSizeMaxBytes = 1 << 20;
  std::ifstream file(path, std::ios::binary);
  std::string text(kSizeMaxBytes, '\0');
  if (!file.read(text.data(), kSizeMaxBytes) && !file.eof()) {
    throw ConfigError({fmt::format("{}: cannot be read: {}", path.string(), std::generic_category().message(errno))});
  }
  if (!file.eof()) {
    throw ConfigError({fmt::format("{}: larger than 1 MiB: not a configuration file", path.string())});
  }
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

void load_entries(std::string_view toml, std::string_view source, std::span<const Entry> entries) {
  const toml::table file = parse(toml, source);
  Loader loader(source, entries);
  loader.load(file, "");
  if (std::vector<std::string> problems = loader.take_problems(); !problems.empty()) {
    throw ConfigError(std::move(problems));
  }
}

}  // namespace odoless
