#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "config/config_error.hpp"
#include "config/entry.hpp"

namespace odoless {

/// Reads a configuration file. Thread: none of these is for a real-time thread.
/// @throws ConfigError if it cannot be read or is larger than a configuration can be.
[[nodiscard]] std::string read_config(const std::filesystem::path& path);

/// Sets the entries that `toml` names. All problems are found before anything is thrown, but entries may be set by
/// then.
/// @param source  The file's name, for messages.
void load_entries(std::string_view toml, std::string_view source, std::span<const Entry> entries);

/// What `write_toml` and `write_reference` are made of.
[[nodiscard]] std::string entries_to_toml(std::span<const Entry> entries);
[[nodiscard]] std::string entries_to_template(std::span<const Entry> entries, std::span<const std::string_view> keys);
[[nodiscard]] std::string entries_to_reference(std::span<const Entry> entries);

/// Overrides members of `params` by the keys of a TOML text; what the text doesn't name stays as it is.
/// @throws ConfigError with every problem of the text; `params` is then unchanged.
template <class Params>
void parse_parameters(std::string_view toml, std::string_view source, Params& params) {
  Params loaded = params;
  load_entries(toml, source, entries_of(loaded));
  params = loaded;
}

/// `parse_parameters` of a file.
template <class Params>
void load_parameters(const std::filesystem::path& path, Params& params) {
  parse_parameters(read_config(path), path.string(), params);
}

/// A configuration file that says what `params` says, with every key's meaning and range as a comment. Loading it into
/// a default `Params` gives `params` again, exactly; an angle that no number of degrees is equal to comes back within
/// one unit in the last place, unless it is the default.
template <class Params>
[[nodiscard]] std::string write_toml(const Params& params) {
  Params copy = params;
  return entries_to_toml(entries_of(copy));
}

/// A configuration file for people to begin with: of these keys alone meaning, range and value, as comments. As it is
/// it changes nothing.
template <class Params>
[[nodiscard]] std::string write_template(const Params& params, std::span<const std::string_view> keys) {
  Params copy = params;
  return entries_to_template(entries_of(copy), keys);
}

/// A Markdown table of all keys: type, default (the value in `params`), range, unit, meaning.
template <class Params>
[[nodiscard]] std::string write_reference(const Params& params) {
  Params copy = params;
  return entries_to_reference(entries_of(copy));
}

}  // namespace odoless
