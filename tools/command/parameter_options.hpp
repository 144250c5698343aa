#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <numbers>
#include <string>
#include <type_traits>
#include <utility>

#include "core/base/parameters.hpp"

namespace odoless {

/// Makes one command-line option of each parameter that a struct describes, with its default, range and sentence:
/// `noise_sd_m` becomes --noise-sd-m. Angles are given in degrees: `field_of_view_rad` becomes --field-of-view-deg,
/// `speed_radps` --speed-degps.
///
/// The struct must outlive the parsing of the command line, which writes to it option by option, in the order of their
/// definition.
class ParameterOptions {
 public:
  /// @param prefix  Of every name, as "tilt_".
  explicit ParameterOptions(CLI::App& command, std::string prefix = {})
      : command_(command), prefix_(std::move(prefix)) {}

  template <class T>
  void value(const std::string& name, T& value, Range<std::type_identity_t<T>> range, const char* sentence) {
    const std::size_t unit = name.rfind("_rad");
    if (unit != std::string::npos && (name.ends_with("_rad") || name.ends_with("_radps"))) {
      add<T>(name.substr(0, unit) + "_deg" + name.substr(unit + 4), value, range, sentence, 180.0 / std::numbers::pi);
    } else {
      add<T>(name, value, range, sentence, 1);
    }
  }

  void text(const std::string& name, std::string& value, const char* sentence) {
    command_.add_option(dashed(name), value, sentence)
        ->check([](const std::string& given) {
          return is_parameter_text(given) ? std::string() : std::string("must be one line, and not too long");
        })
        ->capture_default_str();
  }

  void flag(const std::string& name, bool& value, const char* sentence) {
    command_.add_flag(dashed(name), value, sentence);
  }

 private:
  template <class T>
  void add(const std::string& name, T& value, Range<T> range, const char* sentence, auto shown_per_inner) {
    const auto shown = [=](T inner) { return static_cast<T>(inner * shown_per_inner); };
    command_
        .add_option_function<T>(
            dashed(name),
            [=, &value](const T& given) {
              value = std::clamp(static_cast<T>(given / shown_per_inner), range.min, range.max);
            },
            sentence)
        ->check(CLI::Range(shown(range.min), shown(range.max)))
        ->default_str(CLI::detail::to_string(shown(value)));
  }

  [[nodiscard]] std::string dashed(std::string name) const {
    name.insert(0, prefix_);
    std::replace(name.begin(), name.end(), '_', '-');
    return "--" + name;
  }

  CLI::App& command_;
  std::string prefix_;
};

}  // namespace odoless
