#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "config/file_units.hpp"
#include "core/base/parameters.hpp"

namespace odoless {

/// One parameter with its struct's type erased, in the names and units of the file.
struct Entry {
  /// The alternative tells the kind: real number, whole number, flag, text, or sectors in degrees; a choice is a text
  /// that must be one of `names`.
  using Sectors = std::vector<std::array<double, 2>>;
  using Value = std::variant<double, std::int64_t, bool, std::string, Sectors>;

  std::string key;  ///< with its groups: matcher.cell_size_m
  std::string text;
  Value min{};  ///< as `max`, for numbers only
  Value max{};
  std::span<const char* const> names{};   ///< for choices only
  std::function<Value()> get;             ///< reads the struct
  std::function<void(const Value&)> set;  ///< writes the struct; the value is of `get`'s kind and within its range
};

/// What lies before the last dot of a key: the table that it stands in. Empty for the file's top.
[[nodiscard]] std::string_view table_of(std::string_view key);
/// What lies behind the last dot.
[[nodiscard]] std::string_view name_of(std::string_view key);

/// Visits a struct's `describe` and lists what it finds. The entries point into the struct, which must outlive them.
class EntryCollector {
 public:
  void value(const char* name, double& value, Range<double> range, const char* text);
  void value(const char* name, int& value, Range<int> range, const char* text);
  void value(const char* name, std::int64_t& value, Range<std::int64_t> range, const char* text);
  void flag(const char* name, bool& value, const char* text);
  void text(const char* name, std::string& value, const char* text);
  void sectors(const char* name, std::vector<AngleSector>& value, const char* text);
  template <class Enum>
  void choice(const char* name, Enum& value, std::span<const char* const> names, const char* text) {
    static_assert(std::is_enum_v<Enum>);
    add_choice(
        name, names, text, [&value] { return static_cast<std::size_t>(value); },
        [&value](std::size_t index) { value = static_cast<Enum>(index); });
  }
  template <class Group>
  void group(const char* name, Group& group, const char* /*text*/) {
    const std::string outer = std::exchange(prefix_, prefix_ + name + '.');
    Group::describe(group, *this);
    prefix_ = outer;
  }

  [[nodiscard]] std::vector<Entry> take() { return std::move(entries_); }

 private:
  void add_milliseconds(const char* name, std::int64_t& value_ns, Range<std::int64_t> range_ns, const char* text);
  void add_choice(const char* name, std::span<const char* const> names, const char* text,
                  std::function<std::size_t()> get_index, std::function<void(std::size_t)> set_index);

  std::string prefix_;
  std::vector<Entry> entries_;
};

/// All parameters of a struct, in the order of its description.
template <class Params>
[[nodiscard]] std::vector<Entry> entries_of(Params& params) {
  EntryCollector collector;
  Params::describe(params, collector);
  return collector.take();
}

}  // namespace odoless
