#include "firmware/daemon/control_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>

namespace odoless {
namespace {

using Kind = ControlCommand::Kind;
using Parsed = std::variant<ControlCommand, std::string>;

constexpr double kYawMax_deg = 360.0;
constexpr const char* kPoseForm = "pose needs three numbers: X_M Y_M YAW_DEG";

std::string_view next_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  const std::string_view word = line.substr(0, line.find(' '));
  line.remove_prefix(word.size());
  return word;
}

std::optional<double> number_of(std::string_view word) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  const bool whole = error == std::errc() && end == word.data() + word.size();
  return whole && std::isfinite(number) ? std::optional(number) : std::nullopt;
}

// As much of what was sent as can stand in a line of a log.
std::string shown(std::string_view word) {
  constexpr std::size_t kMost = 40;
  std::string text(word.substr(0, kMost));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text + (word.size() > kMost ? "..." : "");
}

Parsed parse_pose(std::string_view arguments) {
  std::array<double, 3> numbers{};
  for (double& number : numbers) {
    const std::optional<double> found = number_of(next_word(arguments));
    if (!found) {
      return kPoseForm;
    }
    number = *found;
  }
  if (!next_word(arguments).empty()) {
    return kPoseForm;
  }
  if (std::abs(numbers[0]) > kPoseMax_m || std::abs(numbers[1]) > kPoseMax_m) {
    return fmt::format("pose: X_M and Y_M must be from {0} to {1} m", -kPoseMax_m, kPoseMax_m);
  }
  if (std::abs(numbers[2]) > kYawMax_deg) {
    return fmt::format("pose: YAW_DEG must be from {0} to {1} deg", -kYawMax_deg, kYawMax_deg);
  }
  return ControlCommand{.kind = Kind::kPose,
                        .map_T_robot = {numbers[0], numbers[1], wrap_angle(numbers[2] * std::numbers::pi / 180.0)}};
}

Parsed parse_tilt(std::string_view arguments) {
  const std::string_view wanted = next_word(arguments);
  const auto* const found = std::find(std::begin(kTiltCommandNames), std::end(kTiltCommandNames), wanted);
  if (found == std::end(kTiltCommandNames) || !next_word(arguments).empty()) {
    return "tilt needs one of level, sweep, stop";
  }
  return ControlCommand{.kind = Kind::kTilt,
                        .tilt = static_cast<TiltCommand>(std::distance(std::begin(kTiltCommandNames), found))};
}

Parsed parse_question(std::string_view word, std::string_view arguments) {
  const std::string_view form = next_word(arguments);
  if ((!form.empty() && form != "json") || !next_word(arguments).empty()) {
    return fmt::format("{} takes no argument but json", word);
  }
  if (word == "world") {
    return ControlCommand{.kind = form.empty() ? Kind::kWorld : Kind::kWorldJson};
  }
  return ControlCommand{.kind = form.empty() ? Kind::kStatus : Kind::kStatusJson};
}

// A path may have spaces: it is all that is left of the line.
Parsed parse_save(std::string_view arguments) {
  ControlCommand command{.kind = Kind::kSave};
  std::string_view rest = arguments;
  if (next_word(rest) == "--force") {
    command.is_forced = true;
    arguments = rest;
  }
  arguments.remove_prefix(std::min(arguments.find_first_not_of(' '), arguments.size()));
  command.folder = arguments;
  const bool is_printable =
      std::none_of(arguments.begin(), arguments.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; });
  if (!is_printable || (!arguments.empty() && arguments.front() != '/') || (command.is_forced && arguments.empty())) {
    return "save takes nothing, or an absolute path: save [--force] /PATH";
  }
  return command;
}

struct Word {
  std::string_view name;
  Kind kind;
};
constexpr std::array<Word, 6> kPlainCommands{{{"reset", Kind::kReset},
                                              {"pause", Kind::kPause},
                                              {"resume", Kind::kResume},
                                              {"localise", Kind::kLocalise},
                                              {"map", Kind::kMap},
                                              {"stop", Kind::kStop}}};

}  // namespace

Parsed parse_control_command(std::string_view line) {
  const std::string_view word = next_word(line);
  if (word == "pose") {
    return parse_pose(line);
  }
  if (word == "status" || word == "world") {
    return parse_question(word, line);
  }
  if (word == "tilt") {
    return parse_tilt(line);
  }
  if (word == "save") {
    return parse_save(line);
  }
  const auto* const found = std::find_if(kPlainCommands.begin(), kPlainCommands.end(),
                                         [word](const Word& known) { return known.name == word; });
  if (found == kPlainCommands.end()) {
    return fmt::format("'{}' is no command; there are {}", shown(word), kControlCommands);
  }
  if (!next_word(line).empty()) {
    return fmt::format("{} takes no argument", found->name);
  }
  return ControlCommand{.kind = found->kind};
}

}  // namespace odoless
