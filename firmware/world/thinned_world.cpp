#include "firmware/world/thinned_world.hpp"

#include <algorithm>
#include <vector>

#include "core/graph/world_thinning.hpp"

namespace odoless {

namespace {

std::unique_ptr<StoredWorld> without(const StoredWorld& world, const std::vector<int>& needless) {
  auto thin = std::make_unique<StoredWorld>(world.store.size(), world.store.most_beams(), world.graph.size(),
                                            static_cast<int>(world.graph.constraints().size()));
  copy_without(world.world(), needless, thin->store, thin->graph, thin->submaps);
  thin->identity = world.identity;
  thin->submaps_in_file = thin->graph.size();
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
    if (session.submaps == 0) {
      session.odometry.clear();
    }
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

}  // namespace odoless
