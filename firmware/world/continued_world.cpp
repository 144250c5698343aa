#include "firmware/world/continued_world.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <utility>

#include "core/graph/world_thinning.hpp"
#include "firmware/world/thinned_world.hpp"
#include "firmware/world/world_reader.hpp"

namespace odoless {

FileFailure ContinuedWorld::read(WorldFile& file, const RobotParams& params, WorldUse use) {
  WorldReading reading = read_world(file, params);
  if (!reading.world) {
    return {EBADMSG, std::move(reading.wrong)};
  }
  const StoredWorld& world = *reading.world;
  const bool is_read_only = use == WorldUse::kLocalise;
  if (world.submaps.empty()) {
    return is_read_only ? FileFailure{EBADMSG, "there is no map in it yet"} : FileFailure{};
  }
  const bool is_all_in_file = static_cast<int>(world.submaps.size()) == world.submaps_in_file;
  FileFailure failed = is_all_in_file || is_read_only ? FileFailure{} : file.renew_graph(world);
  if (!failed.any()) {
    mirror_ = WorldMirror(world.world());
    stored_ = std::move(reading.world);
  }
  return failed;
}

int ContinuedWorld::make_room(WorldFile& file, const GraphParams& params) {
  if (!stored_ || share_of_pools(stored_->world(), params) < kCrowded_share) {
    return 0;
  }
  std::unique_ptr<StoredWorld> thin = thinned(*stored_);
  const int left_out = thin ? stored_->graph.size() - thin->graph.size() : 0;
  if (!is_worth_leaving_out(static_cast<std::size_t>(left_out), stored_->submaps.size()) ||
      leave_out(file, *stored_, *thin).any()) {
    return 0;
  }
  stored_ = std::move(thin);
  mirror_ = WorldMirror(stored_->world());
  return left_out;
}

std::string no_room_sentence(const StoredWorld& world, const GraphParams& params) {
  return fmt::format(
      "it has {} keyframes of up to {} beams, {} submaps and {} constraints, and the pose graph has room for {}, {}, "
      "{} and {}: raise graph.keyframes_max, keyframe_beams_max, submaps_max and constraints_max beyond that",
      world.store.size(), world.store.most_beams(), world.submaps.size(), world.graph.constraints().size(),
      params.keyframes_max, params.keyframe_beams_max, params.submaps_max, params.constraints_max);
}

}  // namespace odoless
