#include "config/entry.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/check.hpp"

namespace odoless {

std::string_view table_of(std::string_view key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string_view::npos ? std::string_view{} : key.substr(0, dot);
}

std::string_view name_of(std::string_view key) { return key.substr(key.rfind('.') + 1); }

void EntryCollector::value(const char* name, double& value, Range<double> range, const char* text) {
  const FileUnit& unit = file_unit(name);
  entries_.push_back({.key = prefix_ + key_in_file(name),
                      .text = text,
                      .min = to_file(unit, range.min),
                      .max = to_file(unit, range.max),
                      .get = [&value, &unit] { return to_file(unit, value); },
                      .set =
                          [&value, &unit, range](const Entry::Value& number) {
                            // The ends of the range are rounded in the file's unit, but must hold inside.
                            value = std::clamp(from_file(unit, std::get<double>(number)), range.min, range.max);
                          }});
}

void EntryCollector::value(const char* name, int& value, Range<int> range, const char* text) {
  entries_.push_back(
      {.key = prefix_ + name,
       .text = text,
       .min = std::int64_t{range.min},
       .max = std::int64_t{range.max},
       .get = [&value] { return std::int64_t{value}; },
       .set = [&value](const Entry::Value& number) { value = static_cast<int>(std::get<std::int64_t>(number)); }});
}

void EntryCollector::value(const char* name, std::int64_t& value, Range<std::int64_t> range, const char* text) {
  if (std::string_view(name).ends_with("_ns")) {
    add_milliseconds(name, value, range, text);
    return;
  }
  entries_.push_back({.key = prefix_ + name,
                      .text = text,
                      .min = range.min,
                      .max = range.max,
                      .get = [&value] { return value; },
                      .set = [&value](const Entry::Value& number) { value = std::get<std::int64_t>(number); }});
}

void EntryCollector::add_milliseconds(const char* name, std::int64_t& value_ns, Range<std::int64_t> range_ns,
                                      const char* text) {
  const FileUnit& unit = file_unit(name);
  const auto in_file = [&unit](std::int64_t number_ns) { return to_file(unit, static_cast<double>(number_ns)); };
  entries_.push_back({.key = prefix_ + key_in_file(name),
                      .text = text,
                      .min = in_file(range_ns.min),
                      .max = in_file(range_ns.max),
                      .get = [&value_ns, in_file] { return in_file(value_ns); },
                      .set =
                          [&value_ns, range_ns, &unit](const Entry::Value& number) {
                            const double wanted_ns = std::round(from_file(unit, std::get<double>(number)));
                            // Compared before the cast: the largest int64 is not a double.
                            if (wanted_ns >= static_cast<double>(range_ns.max)) {
                              value_ns = range_ns.max;
                            } else {
                              value_ns = std::max(range_ns.min, static_cast<std::int64_t>(wanted_ns));
                            }
                          }});
}

void EntryCollector::flag(const char* name, bool& value, const char* text) {
  entries_.push_back({.key = prefix_ + name,
                      .text = text,
                      .get = [&value] { return value; },
                      .set = [&value](const Entry::Value& flag) { value = std::get<bool>(flag); }});
}

void EntryCollector::text(const char* name, std::string& value, const char* text) {
  entries_.push_back({.key = prefix_ + name,
                      .text = text,
                      .get = [&value] { return value; },
                      .set = [&value](const Entry::Value& words) { value = std::get<std::string>(words); }});
}

void EntryCollector::sectors(const char* name, std::vector<AngleSector>& value, const char* text) {
  const FileUnit& unit = file_unit("_rad");
  auto get = [&value, &unit] {
    Entry::Sectors degrees;
    for (const AngleSector& sector : value) {
      degrees.push_back({to_file(unit, sector.from_rad), to_file(unit, sector.to_rad)});
    }
    return degrees;
  };
  auto set = [&value, &unit](const Entry::Value& wanted) {
    value.clear();
    for (const auto& [from_deg, to_deg] : std::get<Entry::Sectors>(wanted)) {
      value.push_back({from_file(unit, from_deg), from_file(unit, to_deg)});
    }
  };
  entries_.push_back({.key = prefix_ + name, .text = text, .get = std::move(get), .set = std::move(set)});
}

void EntryCollector::add_choice(const char* name, std::span<const char* const> names, const char* text,
                                std::function<std::size_t()> get_index, std::function<void(std::size_t)> set_index) {
  auto get = [names, get_index = std::move(get_index)] {
    const std::size_t index = get_index();
    ODOLESS_CHECK(index < names.size());
    return std::string(names[index]);
  };
  auto set = [names, set_index = std::move(set_index)](const Entry::Value& choice) {
    const auto found = std::find(names.begin(), names.end(), std::get<std::string>(choice));
    ODOLESS_CHECK(found != names.end());
    set_index(static_cast<std::size_t>(found - names.begin()));
  };
  entries_.push_back(
      {.key = prefix_ + name, .text = text, .names = names, .get = std::move(get), .set = std::move(set)});
}

}  // namespace odoless
