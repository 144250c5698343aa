#pragma once

#include "core/slam/hslam_params.hpp"
#include "core/slam/lslam_params.hpp"

namespace odoless {

/// Both levels.
struct SlamParams {
  LslamParams low;
  HslamParams high;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("low", self.low, "Low-level DP-SLAM: from scan to scan.");
    visit.group("high", self.high, "High-level DP-SLAM: from segment to segment, over the whole run.");
  }
};

}  // namespace odoless
