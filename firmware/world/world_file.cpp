#include "firmware/world/world_file.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>

#include "firmware/world/world_blobs.hpp"
#include "firmware/world/world_schema.hpp"

namespace odoless {
namespace {

FileFailure failure_of(int error) { return {error, std::strerror(error)}; }  // NOLINT(concurrency-mt-unsafe)

FileFailure not_a_world(const std::string& wrong) { return {EBADMSG, wrong}; }

std::string new_uuid() {
  std::array<std::uint8_t, 16> bytes{};
  static_cast<void>(::getrandom(bytes.data(), bytes.size(), 0));
  bytes[6] = static_cast<std::uint8_t>((bytes[6] & 0x0fU) | 0x40U);
  bytes[8] = static_cast<std::uint8_t>((bytes[8] & 0x3fU) | 0x80U);
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    text += fmt::format("{}{:02x}", i == 4 || i == 6 || i == 8 || i == 10 ? "-" : "", bytes.at(i));
  }
  return text;
}

/// A new file's name in its folder is to outlast a power cut as well.
void sync_folder_of(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const FileDescriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (descriptor.valid()) {
    static_cast<void>(::fsync(descriptor.get()));
  }
}

}  // namespace

std::string utc_text() {
  const auto now = std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(now)));
}

FileFailure WorldFile::open_to_read(const std::filesystem::path& path) {
  close();
  path_ = path;
  if (::access(path.c_str(), R_OK) != 0) {
    return failure_of(errno);
  }
  FileFailure failed = database_.open(path, Database::Use::kRead);
  if (!failed.any()) {
    failed = refuse_unless_world();
  }
  if (failed.any()) {
    close();
  }
  return failed;
}

FileFailure WorldFile::open_to_write(const std::filesystem::path& path, const std::string& program) {
  close();
  path_ = path;
  FileFailure failed = claim();
  if (!failed.any()) {
    failed = database_.open(path, Database::Use::kWrite);
  }
  if (!failed.any()) {
    failed = prepare(program);
  }
  if (failed.any()) {
    close();
  }
  return failed;
}

// SQLite's own locks last for a transaction each. This one, of another kind, holds for as long as the file is open.
FileFailure WorldFile::claim() {
  const bool is_new = ::access(path_.c_str(), F_OK) != 0;
  lock_.reset(::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (!lock_.valid()) {
    return failure_of(errno);
  }
  if (::flock(lock_.get(), LOCK_EX | LOCK_NB) != 0) {
    return {errno == EWOULDBLOCK ? EBUSY : errno,
            errno == EWOULDBLOCK ? "in use by another program" : "cannot be locked"};
  }
  if (is_new) {
    sync_folder_of(path_);
  }
  return {};
}

// synchronous = FULL: each transaction is on the disk when it is done. With NORMAL, what came since the last
// checkpoint, minutes, could be lost with the power. A checkpoint every 256 pages: on a slow disk one of 1,000, as is
// usual, holds up the next transaction for longer than may be lost.
FileFailure WorldFile::prepare(const std::string& program) {
  std::string wrong;
  const WorldKind kind = kind_of(database_, wrong);
  if (kind == WorldKind::kOther) {
    return not_a_world(wrong);
  }
  FileFailure failed = database_.run(
      "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA wal_autocheckpoint = 256; PRAGMA cache_size = "
      "-2000; PRAGMA foreign_keys = ON;"
      "PRAGMA journal_size_limit = 8388608");
  if (!failed.any() && integer_of(database_, "PRAGMA user_version") < kWorldVersion) {
    failed = bring_up_to_date(kind == WorldKind::kEmpty, program);
  }
  return failed.any() ? failed : refuse_unless_world();
}

// In one transaction, so that a file without its tables or its UUID is never seen.
FileFailure WorldFile::bring_up_to_date(bool is_new, const std::string& program) {
  FileFailure failed = database_.run("BEGIN IMMEDIATE");
  if (!failed.any()) {
    failed = migrate(database_);
  }
  if (!failed.any() && is_new) {
    Statement insert(database_, "INSERT INTO world (uuid, created, program, revision) VALUES (?, ?, ?, 0)");
    failed = insert.run(new_uuid(), utc_text(), program) ? FileFailure{} : database_.failure();
  }
  return failed.any() ? failed : database_.run("COMMIT");
}

FileFailure WorldFile::refuse_unless_world() {
  std::string wrong;
  const WorldKind kind = kind_of(database_, wrong);
  if (kind != WorldKind::kWorld) {
    return not_a_world(kind == WorldKind::kEmpty ? "an empty file" : wrong);
  }
  if (const std::string damage = damage_of(database_, false); !damage.empty()) {
    return not_a_world("damaged: " + damage);
  }
  if (!has_our_tables(database_)) {
    return not_a_world("its tables are not those of a world");
  }
  return read_identity();
}

FileFailure WorldFile::read_identity() {
  Statement select(database_, "SELECT uuid, created, program, revision FROM world");
  if (!select.next()) {
    return not_a_world("it says of no world which one it is");
  }
  identity_ = {select.text(0), select.text(1), select.text(2), select.integer(3)};
  return {};
}

void WorldFile::close() {
  database_.close();
  lock_.reset();
}

bool WorldFile::is_in_place() const {
  struct stat named {};
  struct stat held {};
  return ::stat(path_.c_str(), &named) == 0 && ::fstat(lock_.get(), &held) == 0 && named.st_ino == held.st_ino &&
         named.st_dev == held.st_dev;
}

FileFailure WorldFile::begin(const SessionRecord& session, WorldPlace& place) {
  Statement insert(database_, "INSERT INTO session (started, program, seed, configuration) VALUES (?, ?, ?, ?)");
  if (!insert.run(session.started, session.program, session.seed, session.configuration)) {
    return database_.failure();
  }
  place = {integer_of(database_, "SELECT max(id) FROM session"),
           integer_of(database_, "SELECT ifnull(max(id) + 1, 0) FROM keyframe"),
           integer_of(database_, "SELECT ifnull(max(id) + 1, 0) FROM submap"),
           integer_of(database_, "SELECT ifnull(max(id) + 1, 0) FROM submap_constraint")};
  return place.session < 0 || place.keyframe < 0 || place.submap < 0 || place.constraint < 0 ? database_.failure()
                                                                                             : FileFailure{};
}

FileFailure WorldFile::write(const WorldPlace& place, const WorldChanges& changes) {
  if (changes.is_empty()) {
    return {};
  }
  FileFailure failed = transact([&] { return insert(place, changes); });
  identity_.revision += !failed.any() && changes.is_map_changed() ? 1 : 0;
  return failed;
}

FileFailure WorldFile::erase_keyframes(const WorldPlace& place, int from) {
  FileFailure failed = transact([&] {
    return Statement(database_, "DELETE FROM keyframe WHERE id >= ?").run(place.keyframe + from) && grow_revision();
  });
  identity_.revision += failed.any() ? 0 : 1;
  return failed;
}

FileFailure WorldFile::transact(const std::function<bool()>& change) {
  if (FileFailure failed = database_.run("BEGIN IMMEDIATE"); failed.any()) {
    return failed;
  }
  FileFailure failed = change() ? database_.run("COMMIT") : database_.failure();
  if (failed.any()) {
    static_cast<void>(database_.run("ROLLBACK"));  // some failures have done that already
  }
  return failed;
}

FileFailure WorldFile::renew_graph(const StoredWorld& world) {
  WorldChanges changes;
  changes.submaps = world.submaps;
  for (Submap& each : changes.submaps) {
    each.first_keyframe = world.store.serial(each.first_keyframe);
  }
  for (int i = 0; i < world.graph.size(); ++i) {
    changes.moved.push_back({i, world.graph.pose(i)});
  }
  changes.constraints.assign(world.graph.constraints().begin(), world.graph.constraints().end());
  FileFailure failed = transact([&] { return erase_graph({}) && insert({}, changes); });
  identity_.revision += failed.any() ? 0 : 1;
  return failed;
}

bool WorldFile::erase_graph(const WorldPlace& place) {
  return Statement(database_, "DELETE FROM submap_constraint WHERE id >= ?").run(place.constraint) &&
         Statement(database_, "DELETE FROM submap WHERE id >= ?").run(place.submap);
}

bool WorldFile::insert(const WorldPlace& place, const WorldChanges& changes) {
  if (!erase_left_out(place, changes) || !insert_keyframes(place, changes) || !insert_submaps(place, changes) ||
      !insert_constraints(place, changes)) {
    return false;
  }
  if (!changes.odometry.empty()) {
    Statement odometry(database_, "INSERT INTO odometry (session, poses) VALUES (?, ?)");
    if (!odometry.run(place.session, pack_poses(changes.odometry))) {
      return false;
    }
  }
  if (!changes.left_out.empty() && !forget_odometry()) {
    return false;
  }
  return !changes.is_map_changed() || grow_revision();
}

bool WorldFile::grow_revision() { return Statement(database_, "UPDATE world SET revision = revision + 1").run(); }

bool WorldFile::insert_keyframes(const WorldPlace& place, const WorldChanges& changes) {
  Statement insert(database_, "INSERT INTO keyframe VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (const StoredKeyframe& each : changes.keyframes) {
    const Keyframe& k = each.keyframe;
    if (!insert.run(place.keyframe + each.serial, place.session, k.stamp_ns, k.start_angle_rad, k.angle_step_rad,
                    k.beams, k.map_number, k.odom_T_scan.x_m, k.odom_T_scan.y_m, k.odom_T_scan.yaw_rad,
                    k.map_T_odom.x_m, k.map_T_odom.y_m, k.map_T_odom.yaw_rad, pack_stretch(k.since_last),
                    pack_beams(each.codes))) {
      return false;
    }
  }
  return true;
}

bool WorldFile::insert_submaps(const WorldPlace& place, const WorldChanges& changes) {
  Statement insert(database_,
                   "INSERT INTO submap (id, session, first_keyframe, keyframes, map_x_m, map_y_m, map_yaw_rad) "
                   "VALUES (?1, (SELECT session FROM keyframe WHERE id = ?2), ?2, ?3, 0.0, 0.0, 0.0)");
  std::int64_t id = place.submap + changes.first_submap;
  for (const Submap& each : changes.submaps) {
    if (!insert.run(id++, place.keyframe + each.first_keyframe, each.keyframes)) {
      return false;
    }
  }
  Statement move(database_, "UPDATE submap SET map_x_m = ?, map_y_m = ?, map_yaw_rad = ? WHERE id = ?");
  for (const WorldChanges::Moved& each : changes.moved) {
    const Pose2& pose = each.map_T_submap;
    if (!move.run(pose.x_m, pose.y_m, pose.yaw_rad, place.submap + each.submap)) {
      return false;
    }
  }
  return true;
}

bool WorldFile::insert_constraints(const WorldPlace& place, const WorldChanges& changes) {
  Statement insert(database_, "INSERT INTO submap_constraint VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)");
  std::int64_t id = place.constraint + changes.first_constraint;
  for (const Constraint& each : changes.constraints) {
    if (!insert.run(id++, place.submap + each.from, place.submap + each.to, each.from_T_to.x_m, each.from_T_to.y_m,
                    each.from_T_to.yaw_rad, pack_covariance(each.covariance), each.is_loop ? 1 : 0, each.weight)) {
      return false;
    }
  }
  Statement weigh(database_, "UPDATE submap_constraint SET weight = ? WHERE id = ?");
  for (const WorldChanges::Weighted& each : changes.weighted) {
    if (!weigh.run(each.weight, place.constraint + each.constraint)) {
      return false;
    }
  }
  return true;
}

FileFailure WorldFile::copy_to(const std::filesystem::path& to) {
  FileFailure failed = Statement(database_, "VACUUM INTO ?").run(to.string()) ? FileFailure{} : database_.failure();
  if (!failed.any()) {
    const FileDescriptor descriptor(::open(to.c_str(), O_RDWR | O_CLOEXEC));
    failed = descriptor.valid() && ::fsync(descriptor.get()) == 0 ? FileFailure{} : failure_of(errno);
  }
  if (failed.any()) {
    static_cast<void>(::unlink(to.c_str()));
  }
  return failed;
}

// The lock is held until the new file is in place: nobody writes to the old one meanwhile.
FileFailure WorldFile::compact() {
  const std::filesystem::path made = path_.string() + ".tmp";
  static_cast<void>(::unlink(made.c_str()));
  FileFailure failed = copy_to(made);
  database_.close();  // its log goes into the old file
  if (!failed.any() && ::rename(made.c_str(), path_.c_str()) != 0) {
    failed = failure_of(errno);
    static_cast<void>(::unlink(made.c_str()));
  }
  sync_folder_of(path_);
  close();
  return failed;
}

std::string WorldFile::damage() { return damage_of(database_, true); }

}  // namespace odoless
