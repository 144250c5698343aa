#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/scan/laser_mount_params.hpp"
#include "core/scan/scan_frame.hpp"

namespace odoless {

/// Turns what the laser says into the scan frame, leaves out what it shall not see, and tells the times of beams where
/// the scan does not: the one place where the mount is applied. What is recorded and sent over LCM is as the laser says
/// it, so that it may come in again.
///
/// A laser whose left and right are swapped has its beams given in the reverse order, so that a scan has the same beams
/// in the same order however the laser hangs.
///
/// Thread: owned by one thread. Real time: no allocation after construction; linear in the beams.
class LaserMount {
 public:
  LaserMount(const LaserMountParams& params, int beams_max);

  /// The scan in the scan frame; a view, valid until the next call and while `raw` is. Ignored beams are NaN. A scan
  /// with more beams than `beams_max`, or with angles that are no numbers, comes back as it is.
  [[nodiscard]] RawScan apply(const RawScan& raw);

  /// Sets the ignored ones among ranges that are in the laser's own order to 0: nothing is known.
  void mask(const RawScan& raw, std::span<float> ranges_m);

 private:
  [[nodiscard]] bool is_ignored(double bearing_rad) const;
  [[nodiscard]] bool fits(const RawScan& raw) const;
  /// Brings `ignored_` up to date with the scan's geometry.
  void look_at(const RawScan& raw);

  LaserMountParams params_;
  LaserPlace place_;
  bool has_sectors_;
  std::size_t beams_max_;
  double start_angle_rad_ = 0.0;
  double angle_step_rad_ = 0.0;
  std::vector<std::uint8_t> ignored_;  ///< by the laser's beam; as many as the last scan had
  std::vector<float> ranges_m_;
};

}  // namespace odoless
