#include "firmware/world/continued_world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "firmware/world/world_reader.hpp"

namespace odoless {

FileFailure ContinuedWorld::read(WorldFile& file, const RobotParams& params) {
  WorldReading reading = read_world(file, params);
  if (!reading.world) {
    return {EBADMSG, std::move(reading.wrong)};
  }
  if (!reading.world->is_numbered_as_file) {
    return {EBADMSG, "an earlier session in it ended without its last submap; name a new file, and keep this one"};
  }
  if (reading.world->submaps.empty()) {
    return {};
  }
  mirror_ = WorldMirror(*reading.world);
  const auto last = std::find_if(reading.world->sessions.rbegin(), reading.world->sessions.rend(),
                                 [](const StoredSession& each) { return each.submaps > 0; });
  WorldChanges changes;
  static_cast<void>(mirror_.collect(reading.world->world(), changes));
  FileFailure failed = file.write({.session = last->id}, changes);
  if (!failed.any()) {
    mirror_.take(changes);
    stored_ = std::move(reading.world);
  }
  return failed;
}

std::string no_room_sentence(const StoredWorld& world, const GraphParams& params) {
  return fmt::format(
      "it has {} keyframes of up to {} beams, {} submaps and {} constraints, and the pose graph has room for {}, {}, "
      "{} and {}: raise graph.keyframes_max, keyframe_beams_max, submaps_max and constraints_max beyond that",
      world.store.size(), world.store.most_beams(), world.submaps.size(), world.graph.constraints().size(),
      params.keyframes_max, params.keyframe_beams_max, params.submaps_max, params.constraints_max);
}

}  // namespace odoless
