#include "firmware/world/world_schema.hpp"

#include <fmt/format.h>

#include <array>
#include <vector>

namespace odoless {
namespace {

// One entry per version: what brings a file of the version before to it. Never changed once released.
constexpr std::array<const char*, kWorldVersion> kMigrations{R"sql(
CREATE TABLE world (
  uuid TEXT NOT NULL,
  created TEXT NOT NULL,
  program TEXT NOT NULL,
  revision INTEGER NOT NULL
) STRICT;
CREATE TABLE session (
  id INTEGER PRIMARY KEY,
  started TEXT NOT NULL,
  program TEXT NOT NULL,
  seed INTEGER NOT NULL,
  configuration TEXT NOT NULL
) STRICT;
CREATE TABLE keyframe (
  id INTEGER PRIMARY KEY,
  session INTEGER NOT NULL REFERENCES session,
  stamp_ns INTEGER NOT NULL,
  start_angle_rad REAL NOT NULL,
  angle_step_rad REAL NOT NULL,
  beams INTEGER NOT NULL,
  map_number INTEGER NOT NULL,
  odom_x_m REAL NOT NULL, odom_y_m REAL NOT NULL, odom_yaw_rad REAL NOT NULL,
  map_odom_x_m REAL NOT NULL, map_odom_y_m REAL NOT NULL, map_odom_yaw_rad REAL NOT NULL,
  since_last BLOB NOT NULL,
  ranges BLOB NOT NULL
) STRICT;
CREATE TABLE submap (
  id INTEGER PRIMARY KEY,
  session INTEGER NOT NULL REFERENCES session,
  first_keyframe INTEGER NOT NULL REFERENCES keyframe,
  keyframes INTEGER NOT NULL,
  map_x_m REAL NOT NULL, map_y_m REAL NOT NULL, map_yaw_rad REAL NOT NULL
) STRICT;
CREATE TABLE submap_constraint (
  id INTEGER PRIMARY KEY,
  from_submap INTEGER NOT NULL REFERENCES submap,
  to_submap INTEGER NOT NULL REFERENCES submap,
  x_m REAL NOT NULL, y_m REAL NOT NULL, yaw_rad REAL NOT NULL,
  covariance BLOB NOT NULL,
  is_loop_closure INTEGER NOT NULL,
  weight REAL NOT NULL
) STRICT;
CREATE TABLE odometry (
  id INTEGER PRIMARY KEY,
  session INTEGER NOT NULL REFERENCES session,
  poses BLOB NOT NULL
) STRICT;
)sql"};

std::vector<std::string> tables_of(Database& database) {
  std::vector<std::string> tables;
  Statement statement(database, "SELECT ifnull(sql, name) FROM sqlite_schema ORDER BY name");
  while (statement.next()) {
    tables.push_back(statement.text(0));
  }
  return statement.has_failed() ? std::vector<std::string>{} : tables;
}

}  // namespace

WorldKind kind_of(Database& database, std::string& wrong) {
  const std::int64_t application = integer_of(database, "PRAGMA application_id");
  const std::int64_t version = integer_of(database, "PRAGMA user_version");
  const std::int64_t tables = integer_of(database, "SELECT count(*) FROM sqlite_schema");
  if (application == 0 && version == 0 && tables == 0) {
    return WorldKind::kEmpty;
  }
  if (application != kWorldApplication) {
    wrong = tables < 0 ? "no SQLite file" : "an SQLite file of another program";
    return WorldKind::kOther;
  }
  if (version < 1 || version > kWorldVersion) {
    wrong = fmt::format("a world of version {}, and this program knows 1 to {}", version, kWorldVersion);
    return WorldKind::kOther;
  }
  return WorldKind::kWorld;
}

FileFailure migrate(Database& database) {
  std::string sql = fmt::format("PRAGMA application_id = {};", kWorldApplication);
  for (auto version = integer_of(database, "PRAGMA user_version"); version < kWorldVersion; ++version) {
    sql += kMigrations.at(static_cast<std::size_t>(version));
  }
  return database.run(sql + fmt::format("PRAGMA user_version = {}", kWorldVersion));
}

bool has_our_tables(Database& database) {
  Database fresh;
  return !fresh.open_in_memory().any() && !migrate(fresh).any() && tables_of(fresh) == tables_of(database);
}

std::string damage_of(Database& database, bool whole) {
  Statement statement(database, whole ? "PRAGMA integrity_check(1)" : "PRAGMA quick_check(1)");
  if (!statement.next()) {
    return database.failure().text;
  }
  const std::string said = statement.text(0);
  if (said != "ok") {
    return said;
  }
  if (!whole) {
    return "";
  }
  Statement references(database, "PRAGMA foreign_key_check");
  return references.next() ? fmt::format("row {} of {} names a row of {} that is not there", references.integer(1),
                                         references.text(0), references.text(2))
                           : "";
}

}  // namespace odoless
