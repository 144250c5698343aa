#pragma once

#include <span>
#include <vector>

#include "core/cloud/beam_projector.hpp"

namespace odoless {

/// Which scans of a tilting laser serve 2D SLAM, and what of them.
struct LevelParams {
  double tilt_max_rad = 0.10471975511965978;
  double below_m = 0.4;
  double above_m = 0.6;
  int returns_min = 60;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("tilt_max_rad", self.tilt_max_rad, Range{0.0, 1.5708},
                "Largest tilt at which a scan is used for 2D SLAM.");
    visit.value("below_m", self.below_m, Range{0.0, 100.0},
                "Returns of a tilted scan that lie farther below the level laser are not used for 2D SLAM: they are "
                "the floor.");
    visit.value("above_m", self.above_m, Range{0.0, 100.0},
                "Returns of a tilted scan that lie farther above the level laser are not used for 2D SLAM: they are "
                "lintels or the ceiling.");
    visit.value("returns_min", self.returns_min, Range{8, 16384},
                "Fewest remaining returns with which a tilted scan is used for 2D SLAM.");
  }
};

/// Makes of a slightly tilted scan the one that the level laser would have seen, as far as it can be told: beams that
/// ended near the level laser's height, put where their ends lie in the plane. All other beams say nothing.
///
/// Thread:    owned by one thread.
/// Real time: no allocation after construction; linear in the beams.
class LevelScan {
 public:
  LevelScan(const TiltMount& mount, const LevelParams& params, int beams_max);

  /// The ranges of the level form of `scan`, which has its stamp, angles and beam period, not deskewed; valid until the
  /// next call; 0 where nothing is known. Errc::kTooFewReturns where it is tilted too far or too little remains.
  [[nodiscard]] Result<std::span<const float>> make(const ScanFrame& scan, std::span<const double> tilts_rad);

 private:
  void enter(const BeamPoint& point, const ScanFrame& scan);

  LevelParams params_;
  BeamProjector projector_;
  std::vector<float> ranges_m_;
};

}  // namespace odoless
