#pragma once

#include <string>

#include "core/base/parameters.hpp"
#include "core/graph/submap_graph.hpp"

namespace odoless {

inline constexpr const char* kWorldUseNames[] = {"continue", "localise"};

/// Where what is mapped lasts.
struct WorldParams {
  std::string file;
  WorldUse mode = WorldUse::kContinue;
  double write_every_s = 1.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text(
        "file", self.file,
        "World file that keyframes, submaps and the pose graph are kept in, also over a power cut; made where it "
        "is not there; empty: none. `odolessd --world` says the same.");
    visit.choice("mode", self.mode, kWorldUseNames,
                 "Whether the world grows and is corrected (continue), or is only read, and the robot finds its way in "
                 "it (localise; `odolessd --localise` says the same).");
    visit.value("write_every_s", self.write_every_s, Range{0.1, 1.5},
                "Time after which what is new is written, and the most that a power cut takes, but for the writing.");
  }
};

}  // namespace odoless
