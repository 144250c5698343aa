#include "tools/sim/world_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "core/base/parameters.hpp"
#include "tools/log/fields.hpp"
#include "tools/log/line_reader.hpp"
#include "tools/sim/world_builder.hpp"

namespace odoless {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr Range kCoordinateM{-10'000.0, 10'000.0};
constexpr Range kSizeM{0.001, 10'000.0};
constexpr Range kTableM{0.1, 10'000.0};
constexpr Range kHeightM{0.05, 100.0};
constexpr Range kSpeedMps{0.01, 20.0};
constexpr Range kTurnRateDegps{0.1, 3600.0};
constexpr Range kCornerRadiusM{0.0, 100.0};
constexpr Range kAngleDeg{-360.0, 360.0};

/// Number `index` of a statement; the statement's name is field 0.
double number(const Fields& fields, std::size_t index, const Range<double>& range, const char* what) {
  const double value = fields.number(index, what);
  if (value < range.min || value > range.max) {
    fields.fail(fmt::format("{} is {}", what, value), fmt::format("{} to {}", range.min, range.max));
  }
  return value;
}

Point2 point(const Fields& fields, std::size_t index) {
  return {number(fields, index, kCoordinateM, "X in m"), number(fields, index + 1, kCoordinateM, "Y in m")};
}

void wall(const Fields& fields, WorldBuilder& builder) {
  for (std::size_t i = 3; i < fields.size(); i += 2) {
    const Segment side{point(fields, i - 2), point(fields, i)};
    if (side.a.x_m == side.b.x_m && side.a.y_m == side.b.y_m) {
      fields.fail("two successive points of the wall are the same", "points that differ");
    }
    builder.add_wall(side);
  }
}

void room(const Fields& fields, WorldBuilder& builder) {
  const Point2 corner = point(fields, 1);
  const double width_m = number(fields, 3, kSizeM, "WIDTH in m");
  const double height_m = number(fields, 4, kSizeM, "HEIGHT in m");
  const Pose2 middle{corner.x_m + width_m / 2.0, corner.y_m + height_m / 2.0, 0.0};
  for (const Segment& side : rectangle(middle, width_m, height_m)) {
    builder.add_wall(side);
  }
}

void door(const Fields& fields, WorldBuilder& builder) {
  builder.add_door(point(fields, 1), number(fields, 3, kSizeM, "WIDTH in m"));
}

/// A rectangle's middle and direction: X Y WIDTH HEIGHT [YAW_DEG].
Pose2 middle_pose(const Fields& fields) {
  const Point2 middle = point(fields, 1);
  return {middle.x_m, middle.y_m, fields.size() > 5 ? number(fields, 5, kAngleDeg, "YAW in deg") * kRadPerDeg : 0.0};
}

void box(const Fields& fields, WorldBuilder& builder) {
  const double width_m = number(fields, 3, kSizeM, "WIDTH in m");
  builder.add_box(middle_pose(fields), width_m, number(fields, 4, kSizeM, "HEIGHT in m"));
}

void table(const Fields& fields, WorldBuilder& builder) {
  const double width_m = number(fields, 3, kTableM, "WIDTH in m");
  builder.add_table(middle_pose(fields), width_m, number(fields, 4, kTableM, "DEPTH in m"));
}

void ceiling(const Fields& fields, WorldBuilder& builder) {
  builder.set_ceiling(number(fields, 1, kHeightM, "the ceiling's height in m"));
}

void door_height(const Fields& fields, WorldBuilder& builder) {
  builder.heights().door_m = number(fields, 1, kHeightM, "the doors' height in m");
}

void box_height(const Fields& fields, WorldBuilder& builder) {
  const double height_m = number(fields, 1, {0.0, kHeightM.max}, "the boxes' height in m");
  builder.heights().box_m = height_m > 0.0 ? height_m : WorldBuilder::kCeiling;
}

void table_height(const Fields& fields, WorldBuilder& builder) {
  builder.heights().table_m = number(fields, 1, kHeightM, "the tables' height in m");
}

void pillar(const Fields& fields, WorldBuilder& builder) {
  builder.add_pillar({point(fields, 1), number(fields, 3, kSizeM, "RADIUS in m")});
}

void walker(const Fields& fields, WorldBuilder& builder) {
  Walker walker{number(fields, 1, kSizeM, "RADIUS in m"), number(fields, 2, kSpeedMps, "the speed in m/s"), {}};
  constexpr std::size_t kFirst = 3;
  for (std::size_t i = kFirst; i < fields.size(); i += 2) {
    walker.waypoints.push_back(point(fields, i));
    const Point2& here = walker.waypoints.back();
    if (i > kFirst && here.x_m == walker.waypoints.end()[-2].x_m && here.y_m == walker.waypoints.end()[-2].y_m) {
      fields.fail("two successive points of the walker's way are the same", "points that differ");
    }
  }
  builder.add_walker(walker);
}

void speed(const Fields& fields, WorldBuilder& builder) {
  builder.motion().speed_mps = number(fields, 1, kSpeedMps, "the speed in m/s");
}

void turn_rate(const Fields& fields, WorldBuilder& builder) {
  builder.motion().turn_rate_radps = number(fields, 1, kTurnRateDegps, "the turn rate in deg/s") * kRadPerDeg;
}

void corner_radius(const Fields& fields, WorldBuilder& builder) {
  builder.motion().corner_radius_m = number(fields, 1, kCornerRadiusM, "the corners' radius in m");
}

void go(const Fields& fields, WorldBuilder& builder) {
  for (std::size_t i = 1; i < fields.size(); i += 2) {
    builder.add_waypoint(point(fields, i));
  }
}

struct Statement {
  std::string_view name;
  std::size_t least;  ///< numbers
  std::size_t most;
  bool pairs;
  std::string_view layout;
  void (*apply)(const Fields& fields, WorldBuilder& builder);
};

constexpr std::size_t kAny = 1'000'000;
constexpr std::size_t kShownBytesMax = 24;
constexpr std::array<Statement, 15> kStatements{{
    {"wall", 4, kAny, true, "wall X Y X Y ...", wall},
    {"room", 4, 4, false, "room X Y WIDTH HEIGHT", room},
    {"door", 3, 3, false, "door X Y WIDTH", door},
    {"box", 4, 5, false, "box X Y WIDTH HEIGHT [YAW_DEG]", box},
    {"table", 4, 5, false, "table X Y WIDTH DEPTH [YAW_DEG]", table},
    {"pillar", 3, 3, false, "pillar X Y RADIUS", pillar},
    {"ceiling", 1, 1, false, "ceiling METRES", ceiling},
    {"door_height", 1, 1, false, "door_height METRES", door_height},
    {"box_height", 1, 1, false, "box_height METRES", box_height},
    {"table_height", 1, 1, false, "table_height METRES", table_height},
    {"walker", 6, kAny, true, "walker RADIUS SPEED X Y X Y ...", walker},
    {"speed", 1, 1, false, "speed METRES_PER_SECOND", speed},
    {"turn_rate", 1, 1, false, "turn_rate DEGREES_PER_SECOND", turn_rate},
    {"corner_radius", 1, 1, false, "corner_radius METRES", corner_radius},
    {"go", 2, kAny, true, "go X Y ...", go},
}};

void apply(const Fields& fields, WorldBuilder& builder) {
  const std::string_view name = fields.text(0);
  const auto* const statement =
      std::find_if(kStatements.begin(), kStatements.end(), [&](const Statement& s) { return s.name == name; });
  if (statement == kStatements.end()) {
    fields.fail(fmt::format("{:?} is no statement", name.substr(0, kShownBytesMax)), "one of\n" + world_statements());
  }
  const std::size_t size = fields.size() - 1;
  if (size < statement->least || size > statement->most || (statement->pairs && size % 2 != 0)) {
    fields.fail(fmt::format("`{}` with {} numbers", name, size), fmt::format("`{}`", statement->layout));
  }
  statement->apply(fields, builder);
}

World build_world(LineReader& lines) {
  WorldBuilder builder(lines.name());
  Fields fields;
  std::string_view line;
  while (lines.next(line)) {
    fields.split(line.substr(0, line.find('#')), lines);
    builder.at_line(lines.number());
    if (fields.size() > 0) {
      constexpr std::size_t kStatement_bytes = 256;  // more than any makes
      lines.keep(kStatement_bytes);
      apply(fields, builder);
    }
  }
  return builder.build();
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
  LineReader lines(view_bytes(text, name), name);
  return build_world(lines);
}

World read_world(const std::filesystem::path& file) {
  LineReader lines(open_bytes(file), file.string());
  return build_world(lines);
}

}  // namespace odoless
