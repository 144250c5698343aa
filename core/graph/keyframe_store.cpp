#include "core/graph/keyframe_store.hpp"

#include <algorithm>

#include "core/base/check.hpp"

namespace odoless {

KeyframeStore::KeyframeStore(int keyframes_max, int beams_max)
    : keyframes_max_(static_cast<std::size_t>(keyframes_max)) {
  kept_.reserve(keyframes_max_);
  codes_.reserve(keyframes_max_ * static_cast<std::size_t>(beams_max));
  loaded_m_.reserve(static_cast<std::size_t>(beams_max));
}

int KeyframeStore::add(const Keyframe& keyframe, std::span<const BeamCode> codes, int serial) {
  ODOLESS_CHECK(!full() && codes.size() == static_cast<std::size_t>(keyframe.beams) && serial >= next_serial_);
  kept_.push_back({keyframe, {}, codes_.size(), serial});
  next_serial_ = serial + 1;
  codes_.insert(codes_.end(), codes.begin(), codes.end());
  return size() - 1;
}

void KeyframeStore::erase(const std::vector<bool>& is_gone) {
  std::size_t stays = 0;
  std::size_t codes = 0;
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    if (!is_gone[i]) {
      Kept kept = kept_[i];
      const auto first = codes_.begin() + static_cast<std::ptrdiff_t>(kept.first_code);
      if (codes < kept.first_code) {
        std::copy(first, first + kept.keyframe.beams, codes_.begin() + static_cast<std::ptrdiff_t>(codes));
      }
      kept.first_code = codes;
      codes += static_cast<std::size_t>(kept.keyframe.beams);
      kept_[stays++] = kept;
    }
  }
  kept_.resize(stays);
  codes_.resize(codes);
}

int KeyframeStore::most_beams() const {
  int most = 0;
  for (int i = 0; i < size(); ++i) {
    most = std::max(most, static_cast<int>(at(i).keyframe.beams));
  }
  return most;
}

std::span<const BeamCode> KeyframeStore::codes(int index) const {
  return std::span(codes_).subspan(at(index).first_code, static_cast<std::size_t>(at(index).keyframe.beams));
}

double KeyframeStore::farthest_m(int index) const {
  float farthest_m = 0.0F;
  for (const BeamCode code : codes(index)) {
    const float range_m = range_of(code);
    farthest_m = range_m == kNoReturn_m ? farthest_m : std::max(farthest_m, range_m);
  }
  return static_cast<double>(farthest_m);
}

void KeyframeStore::load(int index, int stride, ScanFrame& frame) const {
  const Keyframe& keyframe = (*this)[index];
  const std::span<const BeamCode> all = codes(index);
  loaded_m_.clear();
  for (std::size_t i = 0; i < all.size(); i += static_cast<std::size_t>(stride)) {
    loaded_m_.push_back(range_of(all[i]));
  }
  const RawScan raw{.stamp_ns = keyframe.stamp_ns,
                    .start_angle_rad = keyframe.start_angle_rad,
                    .angle_step_rad = keyframe.angle_step_rad * stride,
                    .no_return_m = kNoReturn_m,
                    .ranges_m = loaded_m_};
  ODOLESS_CHECK(frame.assign(raw) == Errc::kOk);
}

}  // namespace odoless
