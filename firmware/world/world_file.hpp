#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "drivers/io/file_descriptor.hpp"
#include "firmware/world/database.hpp"
#include "firmware/world/world_contents.hpp"

namespace odoless {

/// A world on the disk: one SQLite database, in README.md. What was written is there after a power cut; one transaction
/// is there whole or not at all.
///
/// Thread: one at a time. Not for real-time threads.
class WorldFile {
 public:
  /// To read it, also while another program writes. Refuses what is no world, of a version that is not known, or
  /// damaged.
  FileFailure open_to_read(const std::filesystem::path& path);
  /// To add to it, made where it is not there; for one program at a time.
  /// @param program  Version, for a new file.
  FileFailure open_to_write(const std::filesystem::path& path, const std::string& program);
  /// What a writer leaves is one file, unless another program reads it now.
  void close();
  [[nodiscard]] bool is_open() const { return database_.is_open(); }
  /// Whether the path still leads to the file that is open.
  [[nodiscard]] bool is_in_place() const;

  [[nodiscard]] const WorldIdentity& identity() const { return identity_; }

  /// A session's record. @param place  Set: where it goes.
  FileFailure begin(const SessionRecord& session, WorldPlace& place);
  /// All of it or nothing, in one transaction. What is left out takes the odometry of its session along, up to the
  /// first keyframe that stays.
  FileFailure write(const WorldPlace& place, const WorldChanges& changes);
  /// Takes out the last session's keyframes from that serial number on, which are in no submap.
  FileFailure erase_keyframes(const WorldPlace& place, int from);

  /// Writes all submaps and constraints anew, as a world that was read has them: with those that were made then, and
  /// its numbers. All of it or nothing.
  FileFailure renew_graph(const StoredWorld& world);

  /// Writes all of it to another file, which is not there, as small as it can be. What fails leaves none.
  FileFailure copy_to(const std::filesystem::path& to);

  /// Writes the file anew, as small as it can be, in the place of the old one, and closes it. Only of a writer. What
  /// fails leaves the old one.
  FileFailure compact();

  /// What is wrong with the pages; empty: nothing.
  [[nodiscard]] std::string damage();
  [[nodiscard]] Database& database() { return database_; }

 private:
  FileFailure claim();
  FileFailure prepare(const std::string& program);
  FileFailure bring_up_to_date(bool is_new, const std::string& program);
  FileFailure refuse_unless_world();
  FileFailure read_identity();
  /// One transaction. @param change  Says whether it could.
  FileFailure transact(const std::function<bool()>& change);
  [[nodiscard]] bool erase_graph(const WorldPlace& place);
  [[nodiscard]] bool erase_left_out(const WorldPlace& place, const WorldChanges& changes);
  [[nodiscard]] bool insert(const WorldPlace& place, const WorldChanges& changes);
  [[nodiscard]] bool forget_odometry();
  [[nodiscard]] bool forget_odometry(std::int64_t session, std::int64_t before_ns);
  [[nodiscard]] bool grow_revision();
  [[nodiscard]] bool insert_keyframes(const WorldPlace& place, const WorldChanges& changes);
  [[nodiscard]] bool insert_submaps(const WorldPlace& place, const WorldChanges& changes);
  [[nodiscard]] bool insert_constraints(const WorldPlace& place, const WorldChanges& changes);

  std::filesystem::path path_;
  FileDescriptor lock_;  ///< closed after the database, whose own locks would go with it
  Database database_;
  WorldIdentity identity_;
};

/// Now, in UTC, as in 2026-11-23T08:15:00Z.
[[nodiscard]] std::string utc_text();

}  // namespace odoless
