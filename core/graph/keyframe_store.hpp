#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/graph/keyframe.hpp"

namespace odoless {

/// All keyframes of a world with their beams.
///
/// Thread: owned by one thread. Memory is fixed at construction. Not for real-time threads.
class KeyframeStore {
 public:
  /// @param beams_max  Of a keyframe.
  KeyframeStore(int keyframes_max, int beams_max);

  [[nodiscard]] bool full() const { return kept_.size() == keyframes_max_; }
  /// Only when not full. @return  Its index.
  int add(const Keyframe& keyframe, std::span<const BeamCode> codes) { return add(keyframe, codes, next_serial_); }
  /// The same of a keyframe that has its serial number, higher than those before it.
  int add(const Keyframe& keyframe, std::span<const BeamCode> codes, int serial);
  /// Takes out the keyframes for which that is so; those behind them have lower numbers. Linear.
  void erase(const std::vector<bool>& is_gone);
  /// In its submap's frame, once that is known.
  void place(int index, const Pose2& submap_T_scan) { at(index).submap_T_scan = submap_T_scan; }
  /// Those between it and the one before are taken out.
  void set_since_last(int index, const OdometryStretch& since_last) { at(index).keyframe.since_last = since_last; }

  [[nodiscard]] int size() const { return static_cast<int>(kept_.size()); }
  /// What a keyframe is known by, whatever is taken out before it: it grows with each. At the end: the next one's.
  [[nodiscard]] int serial(int index) const { return index < size() ? at(index).serial : next_serial_; }
  [[nodiscard]] const Keyframe& operator[](int index) const { return at(index).keyframe; }
  [[nodiscard]] const Pose2& submap_T_scan(int index) const { return at(index).submap_T_scan; }
  /// Beams of the keyframe with the most.
  [[nodiscard]] int most_beams() const;
  [[nodiscard]] std::span<const BeamCode> codes(int index) const;
  /// Every `stride`-th beam of a keyframe, as the scan that it was. `frame` has room for them.
  void load(int index, int stride, ScanFrame& frame) const;
  /// Largest range of a keyframe's returns; 0: none.
  [[nodiscard]] double farthest_m(int index) const;

 private:
  struct Kept {
    Keyframe keyframe;
    Pose2 submap_T_scan{};
    std::size_t first_code = 0;
    int serial = 0;
  };

  [[nodiscard]] Kept& at(int index) { return kept_[static_cast<std::size_t>(index)]; }
  [[nodiscard]] const Kept& at(int index) const { return kept_[static_cast<std::size_t>(index)]; }

  std::size_t keyframes_max_;
  int next_serial_ = 0;
  std::vector<Kept> kept_;
  std::vector<BeamCode> codes_;
  mutable std::vector<float> loaded_m_;
};

}  // namespace odoless
