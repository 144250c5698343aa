#include "firmware/gpio/gpio_change.hpp"

#include <algorithm>

namespace odoless {
namespace {

template <class Enum, std::size_t kCount>
std::optional<Enum> named(std::string_view word, const std::array<const char*, kCount>& names) {
  const auto found = std::find(names.begin(), names.end(), word);
  return found == names.end() ? std::nullopt : std::optional(static_cast<Enum>(found - names.begin()));
}

}  // namespace

std::string_view gpio_text(const GpioChange& change, std::span<char, kGpioTextMax> buffer) {
  auto end = buffer.begin();
  const auto append = [&end](std::string_view word) { end = std::copy(word.begin(), word.end(), end); };
  append(kGpioPinNames.at(static_cast<std::size_t>(change.pin)));
  append(" ");
  append(kGpioLevelNames.at(static_cast<std::size_t>(change.level)));
  append("\n");
  return {buffer.data(), static_cast<std::size_t>(end - buffer.begin())};
}

std::optional<GpioChange> parse_gpio_text(std::string_view text) {
  const std::size_t space = text.find(' ');
  if (space == std::string_view::npos || !text.ends_with('\n')) {
    return std::nullopt;
  }
  const auto pin = named<GpioPin>(text.substr(0, space), kGpioPinNames);
  const auto level = named<GpioLevel>(text.substr(space + 1, text.size() - space - 2), kGpioLevelNames);
  return pin && level ? std::optional(GpioChange{*pin, *level}) : std::nullopt;
}

}  // namespace odoless
