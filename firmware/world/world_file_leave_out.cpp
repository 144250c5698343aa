// What goes from a file when newer visits have made submaps needless (world_file.hpp).
#include <algorithm>
#include <utility>
#include <vector>

#include "firmware/world/world_blobs.hpp"
#include "firmware/world/world_file.hpp"

namespace odoless {

bool WorldFile::erase_left_out(const WorldPlace& place, const WorldChanges& changes) {
  bool is_done = changes.left_out.empty() || erase_graph(place);
  Statement erase(database_, "DELETE FROM keyframe WHERE id = ?");
  for (const int serial : changes.left_out) {
    is_done = is_done && erase.run(place.keyframe + serial);
  }
  Statement set_way(database_, "UPDATE keyframe SET since_last = ? WHERE id = ?");
  for (const WorldChanges::Way& each : changes.ways) {
    is_done = is_done && set_way.run(pack_stretch(each.since_last), place.keyframe + each.keyframe);
  }
  return is_done;
}

// What lies before all that is left of a session, nothing places in the map any more.
bool WorldFile::forget_odometry() {
  std::vector<std::pair<std::int64_t, std::int64_t>> sessions;  // and the stamp of the first keyframe
  Statement select(database_, "SELECT session, min(stamp_ns) FROM keyframe GROUP BY session");
  while (select.next()) {
    sessions.emplace_back(select.integer(0), select.integer(1));
  }
  bool is_done = !select.has_failed() &&
                 Statement(database_,
                           "DELETE FROM odometry WHERE session < (SELECT max(session) FROM keyframe) AND session NOT "
                           "IN (SELECT session FROM keyframe)")
                     .run();
  for (const auto& [session, first_ns] : sessions) {
    is_done = is_done && forget_odometry(session, first_ns);
  }
  return is_done;
}

bool WorldFile::forget_odometry(std::int64_t session, std::int64_t before_ns) {
  Statement rows(database_, "SELECT id, poses FROM odometry WHERE session = ? ORDER BY id");
  Statement erase(database_, "DELETE FROM odometry WHERE id = ?");
  Statement shorten(database_, "UPDATE odometry SET poses = ? WHERE id = ?");
  rows.bind(1, session);
  std::vector<std::int64_t> gone;
  std::vector<StampedPose> poses;
  std::int64_t shorter = -1;
  while (shorter < 0 && rows.next()) {
    poses.clear();
    if (!unpack_poses(rows.bytes(1), poses)) {
      return false;
    }
    std::erase_if(poses, [&](const StampedPose& each) { return each.stamp_ns < before_ns; });
    if (poses.empty()) {
      gone.push_back(rows.integer(0));
    } else {
      shorter = rows.integer(0);
    }
  }
  bool is_done = !rows.has_failed() && (shorter < 0 || shorten.run(pack_poses(poses), shorter));
  for (const std::int64_t id : gone) {
    is_done = is_done && erase.run(id);
  }
  return is_done;
}

}  // namespace odoless
