#pragma once

#include <span>

#include "core/cloud/beam_projector.hpp"
#include "core/cloud/keyed_cloud.hpp"

namespace odoless {

/// Makes a cloud of the scans of a tilting laser whose motion is known: begins a key pose after some travel, and hangs
/// on it what is seen from then on.
///
/// Frames:    `odom` is smooth from scan to scan and may drift; `map` is where the keys are put, corrected later.
/// Thread:    owned by one thread.
/// Real time: no allocation after construction; linear in the beams.
class CloudMapper {
 public:
  CloudMapper(const CloudParams& params, const TiltMount& mount, int beams_max);

  /// Adds a scan, which has not been deskewed.
  /// @param tilts_rad   One angle per beam; beams whose angle is not finite (unknown) are left out.
  /// @param odom        The level laser's motion during the scan, with `odom` as its target.
  /// @param map_T_odom  As known now; for the key, if one begins.
  void add(const ScanFrame& scan, std::span<const double> tilts_rad, const ScanMotion& odom, const Pose2& map_T_odom);
  /// Begins a key with the next scan: the map was left.
  void reset() { has_key_ = false; }

  [[nodiscard]] KeyedCloud& cloud() { return cloud_; }
  [[nodiscard]] const KeyedCloud& cloud() const { return cloud_; }
  [[nodiscard]] const TiltMount& mount() const { return projector_.mount(); }

 private:
  [[nodiscard]] bool key_is_due(const Pose2& odom_T_scan) const;

  CloudParams params_;
  BeamProjector projector_;
  KeyedCloud cloud_;
  Pose2 odom_T_key_{};
  bool has_key_ = false;
};

}  // namespace odoless
