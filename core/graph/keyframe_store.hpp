#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/scan/scan_frame.hpp"

namespace odoless {

/// A scan that is kept for good.
struct Keyframe {
  std::int64_t stamp_ns = 0;
  Pose2 submap_T_scan{};
  double start_angle_rad = 0.0;
  double angle_step_rad = 0.0;
  std::size_t first_range = 0;  ///< in the store
  int beams = 0;
};

/// Keyframes with their ranges in 16 bits: 4 mm up to 262 m. Beams are stored at even angles; one that the deskewing
/// has moved goes to the angle next to it.
///
/// Thread: owned by one thread. Memory grows up to the capacities and never beyond. Not for real-time threads.
class KeyframeStore {
 public:
  /// @param beams_max  Of a keyframe; of scans with more only every n-th beam is kept.
  KeyframeStore(int keyframes_max, int beams_max) : keyframes_max_(keyframes_max), beams_max_(beams_max) {}

  [[nodiscard]] bool full() const { return size() >= keyframes_max_; }
  /// Only when not full. @return  Its index.
  int add(const ScanFrame& scan, const Pose2& submap_T_scan);
  /// Of the submap's frame, once that is known.
  void place(int index, const Pose2& submap_T_scan) { at(index).submap_T_scan = submap_T_scan; }

  [[nodiscard]] int size() const { return static_cast<int>(keyframes_.size()); }
  [[nodiscard]] const Keyframe& operator[](int index) const { return keyframes_[static_cast<std::size_t>(index)]; }
  /// Every `stride`-th beam of a keyframe, as the scan that it was. `frame` has room for them.
  void load(int index, int stride, ScanFrame& frame) const;
  /// Largest range of a keyframe's returns; 0: none.
  [[nodiscard]] double farthest_m(int index) const;
  [[nodiscard]] std::size_t memory_bytes() const {
    return keyframes_.capacity() * sizeof(Keyframe) + ranges_.capacity() * sizeof(std::uint16_t);
  }

 private:
  [[nodiscard]] Keyframe& at(int index) { return keyframes_[static_cast<std::size_t>(index)]; }

  int keyframes_max_;
  int beams_max_;
  std::vector<Keyframe> keyframes_;
  std::vector<std::uint16_t> ranges_;  ///< kUnit_m each; kInvalid, kNoReturn
  mutable std::vector<float> loaded_;
};

}  // namespace odoless
