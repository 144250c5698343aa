#include "tools/experiment/recorded_scenes.hpp"

namespace odoless {
namespace {

Scene recorded(const char* log, const char* reference, const char* relations) {
  Scene scene;
  scene.log = log;
  scene.reference = reference;
  scene.relations = relations;
  return scene;
}

}  // namespace

Scene dwing_scene() { return recorded("dwing-loop5.log.xz", "dwing-dpslam-with-odometry.tum.xz", ""); }
Scene fr079_scene() { return recorded("fr079.clf.xz", "fr079-gmapping.traj.xz", "fr079.relations.xz"); }
Scene aces_scene() { return recorded("aces.clf.xz", "", "aces.relations.xz"); }
Scene orebro_scene() { return recorded("orebro-corrected.log.gz", "orebro-corrected.log.gz", ""); }

}  // namespace odoless
