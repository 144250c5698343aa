#include "firmware/world/thinned_world.hpp"

#include <algorithm>
#include <vector>

#include "core/graph/world_thinning.hpp"
#include "firmware/world/world_mirror.hpp"

namespace odoless {

namespace {

std::unique_ptr<StoredWorld> without(const StoredWorld& world, const std::vector<int>& needless) {
  auto thin = std::make_unique<StoredWorld>(world);
  static_cast<void>(leave_out(needless, thin->store, thin->graph, thin->submaps));
  thin->submaps_in_file = thin->graph.size();
  thin->sessions.clear();
  int submap = 0;
  int keyframe = 0;
  for (StoredSession session : world.sessions) {
    const auto gone = [&](int first) { return std::ranges::lower_bound(needless, first) - needless.begin(); };
    session.submaps -= static_cast<int>(gone(session.first_submap + session.submaps) - gone(session.first_submap));
    session.first_submap = submap;
    session.first_keyframe = keyframe;
    submap += session.submaps;
    const int end = submap > 0 ? thin->submaps[static_cast<std::size_t>(submap) - 1].end_keyframe() : 0;
    session.keyframes = end - keyframe;
    keyframe = end;
    std::erase_if(session.odometry, [&](const StampedPose& each) {
      return session.submaps == 0 || each.stamp_ns < thin->store[session.first_keyframe].stamp_ns;
    });
    thin->sessions.push_back(std::move(session));
  }
  return thin;
}

}  // namespace

// Again: what was handed over may tie a submap to newer ones that nothing tied it to before.
std::unique_ptr<StoredWorld> thinned(const StoredWorld& world) {
  std::unique_ptr<StoredWorld> thin;
  const StoredWorld* left = &world;
  for (std::vector<int> needless; !(needless = needless_submaps(left->world())).empty(); left = thin.get()) {
    thin = without(*left, needless);
  }
  return thin;
}

FileFailure leave_out(WorldFile& file, const StoredWorld& world, const StoredWorld& thin) {
  WorldChanges changes;
  static_cast<void>(WorldMirror(world.world()).collect(thin.world(), thin.store.size(), changes));
  return file.write({}, changes);
}

}  // namespace odoless
