#include "tools/experiment/experiment.hpp"

#include <algorithm>

#include "core/base/check.hpp"
#include "tools/experiment/groups.hpp"

namespace odoless {

const Run& Evidence::find(const std::string& name) const {
  const auto run = std::find_if(runs_.begin(), runs_.end(), [&](const Run& r) { return r.name == name; });
  ODOLESS_CHECK(run != runs_.end());
  return *run;
}

std::vector<Experiment> all_experiments(Extent extent) {
  std::vector<Experiment> all;
  for (const auto group : {matching_experiments, drift_experiments, recorded_matching_experiments, motion_experiments,
                           mapping_experiments, recorded_mapping_experiments, cloud_experiments, world_experiments}) {
    for (Experiment& experiment : group(extent)) {
      all.push_back(std::move(experiment));
    }
  }
  return all;
}

}  // namespace odoless
