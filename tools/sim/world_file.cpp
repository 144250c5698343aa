#include "tools/sim/world_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <span>
#include <vector>

#include "core/base/parameters.hpp"
#include "tools/command/error.hpp"
#include "tools/sim/world_builder.hpp"

namespace odoless {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr Range kCoordinateM{-10'000.0, 10'000.0};
constexpr Range kSizeM{0.001, 10'000.0};
constexpr Range kSpeedMps{0.01, 20.0};
constexpr Range kTurnRateDegps{0.1, 3600.0};
constexpr Range kCornerRadiusM{0.0, 100.0};
constexpr Range kAngleDeg{-360.0, 360.0};

/// The numbers of one statement.
class Arguments {
 public:
  Arguments(std::string name, int line) : name_(std::move(name)), line_(line) {}

  void add(std::string_view word) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
      fail(fmt::format("`{}` is no number", word), "a decimal number such as 2.5");
    }
    values_.push_back(value);
  }
  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] int line() const { return line_; }
  [[nodiscard]] double get(std::size_t index, const Range<double>& range, const char* what) const {
    const double value = values_[index];
    if (value < range.min || value > range.max) {
      fail(fmt::format("{} is {}", what, value), fmt::format("{} to {}", range.min, range.max));
    }
    return value;
  }
  [[nodiscard]] Point2 point(std::size_t index) const {
    return {get(index, kCoordinateM, "X in m"), get(index + 1, kCoordinateM, "Y in m")};
  }
  [[noreturn]] void fail(const std::string& wrong, const std::string& right) const {
    throw DataError(name_, line_, wrong, right);
  }

 private:
  std::string name_;
  int line_;
  std::vector<double> values_;
};

void wall(const Arguments& arguments, WorldBuilder& builder) {
  for (std::size_t i = 2; i < arguments.size(); i += 2) {
    const Segment side{arguments.point(i - 2), arguments.point(i)};
    if (side.a.x_m == side.b.x_m && side.a.y_m == side.b.y_m) {
      arguments.fail("two successive points of the wall are the same", "points that differ");
    }
    builder.add_wall(side);
  }
}

void room(const Arguments& arguments, WorldBuilder& builder) {
  const Point2 corner = arguments.point(0);
  const double width_m = arguments.get(2, kSizeM, "WIDTH in m");
  const double height_m = arguments.get(3, kSizeM, "HEIGHT in m");
  for (const Segment& side :
       rectangle({corner.x_m + width_m / 2.0, corner.y_m + height_m / 2.0, 0.0}, width_m, height_m)) {
    builder.add_wall(side);
  }
}

void door(const Arguments& arguments, WorldBuilder& builder) {
  builder.add_door(arguments.point(0), arguments.get(2, kSizeM, "WIDTH in m"), arguments.line());
}

void box(const Arguments& arguments, WorldBuilder& builder) {
  const Point2 middle = arguments.point(0);
  const double yaw_rad = arguments.size() > 4 ? arguments.get(4, kAngleDeg, "YAW in deg") * kRadPerDeg : 0.0;
  for (const Segment& side : rectangle({middle.x_m, middle.y_m, yaw_rad}, arguments.get(2, kSizeM, "WIDTH in m"),
                                       arguments.get(3, kSizeM, "HEIGHT in m"))) {
    builder.add_furniture(side);
  }
}

void pillar(const Arguments& arguments, WorldBuilder& builder) {
  builder.add_pillar({arguments.point(0), arguments.get(2, kSizeM, "RADIUS in m")});
}

void speed(const Arguments& arguments, WorldBuilder& builder) {
  builder.motion().speed_mps = arguments.get(0, kSpeedMps, "the speed in m/s");
}

void turn_rate(const Arguments& arguments, WorldBuilder& builder) {
  builder.motion().turn_rate_radps = arguments.get(0, kTurnRateDegps, "the turn rate in deg/s") * kRadPerDeg;
}

void corner_radius(const Arguments& arguments, WorldBuilder& builder) {
  builder.motion().corner_radius_m = arguments.get(0, kCornerRadiusM, "the corners' radius in m");
}

void go(const Arguments& arguments, WorldBuilder& builder) {
  for (std::size_t i = 0; i < arguments.size(); i += 2) {
    builder.add_waypoint(arguments.point(i), arguments.line());
  }
}

struct Statement {
  std::string_view name;
  std::size_t least;  ///< numbers
  std::size_t most;
  bool pairs;
  std::string_view layout;
  void (*apply)(const Arguments&, WorldBuilder&);
};

constexpr std::size_t kAny = 1'000'000;
constexpr std::array<Statement, 9> kStatements{{
    {"wall", 4, kAny, true, "wall X Y X Y ...", wall},
    {"room", 4, 4, false, "room X Y WIDTH HEIGHT", room},
    {"door", 3, 3, false, "door X Y WIDTH", door},
    {"box", 4, 5, false, "box X Y WIDTH HEIGHT [YAW_DEG]", box},
    {"pillar", 3, 3, false, "pillar X Y RADIUS", pillar},
    {"speed", 1, 1, false, "speed METRES_PER_SECOND", speed},
    {"turn_rate", 1, 1, false, "turn_rate DEGREES_PER_SECOND", turn_rate},
    {"corner_radius", 1, 1, false, "corner_radius METRES", corner_radius},
    {"go", 2, kAny, true, "go X Y ...", go},
}};

std::string_view take_word(std::string_view& text) {
  constexpr std::string_view kBlanks = " \t\r";
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
  text.remove_prefix(word.size());
  return word;
}

void parse_line(std::string_view text, Arguments& arguments, WorldBuilder& builder) {
  text = text.substr(0, text.find('#'));
  const std::string_view name = take_word(text);
  if (name.empty()) {
    return;
  }
  const auto* const statement =
      std::find_if(kStatements.begin(), kStatements.end(), [&](const Statement& s) { return s.name == name; });
  if (statement == kStatements.end()) {
    arguments.fail(fmt::format("`{}` is no statement", name), "one of\n" + world_statements());
  }
  for (std::string_view word = take_word(text); !word.empty(); word = take_word(text)) {
    arguments.add(word);
  }
  const std::size_t size = arguments.size();
  if (size < statement->least || size > statement->most || (statement->pairs && size % 2 != 0)) {
    arguments.fail(fmt::format("`{}` with {} numbers", name, size), fmt::format("`{}`", statement->layout));
  }
  statement->apply(arguments, builder);
}

}  // namespace

std::string world_statements() {
  std::string lines;
  for (const Statement& statement : kStatements) {
    lines += fmt::format("  {}\n", statement.layout);
  }
  return lines;
}

World parse_world(std::string_view text, const std::string& name) {
  WorldBuilder builder(name);
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    Arguments arguments(name, line);
    parse_line(text.substr(0, end), arguments, builder);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return builder.build();
}

World read_world(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in) {
    throw NoInputError(file.string() + ": cannot be read; expected a world file");
  }
  return parse_world(text, file.string());
}

}  // namespace odoless
