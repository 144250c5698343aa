#include "core/graph/submap_builder.hpp"

#include <cstddef>

#include "core/math/elementary.hpp"

namespace odoless {

Submap make_submap(KeyframeStore& store, int first_keyframe, int keyframes) {
  const Keyframe& origin = store[first_keyframe + keyframes / 2];
  const int end = first_keyframe + keyframes;
  for (int k = first_keyframe; k < end; ++k) {
    store.place(k, origin.odom_T_scan.inverse() * store[k].odom_T_scan);
  }
  return {.first_keyframe = first_keyframe,
          .keyframes = keyframes,
          .odom_T_submap = origin.odom_T_scan,
          .local_T_submap = store[end - 1].map_T_odom * origin.odom_T_scan,
          .origin_stamp_ns = origin.stamp_ns};
}

SubmapBuilder::SubmapBuilder(const GraphParams& params) : params_(params) {
  begun_.reserve(static_cast<std::size_t>(params.submap_keyframes));
}

bool SubmapBuilder::is_full() const {
  constexpr std::size_t kSlipping_min = 3;
  return travel_m_ >= params_.submap_travel_m || static_cast<int>(begun_.size()) >= params_.submap_keyframes ||
         (slip_m_ > params_.submap_slip_m && begun_.size() >= kSlipping_min);
}

void SubmapBuilder::pass(const OdometryStretch& step) {
  since_stored_ = since_stored_.then(step);
  travel_m_ += step.distance_m;
  slip_m_ += math::hypot(step.slip_m.x_m, step.slip_m.y_m);
}

void SubmapBuilder::add(const Keyframe& keyframe, std::span<const BeamCode> codes, KeyframeStore& store) {
  pass(keyframe.since_last);
  if (!store.full()) {
    begun_.push_back({store.add(keyframe, codes), since_stored_});
    since_stored_ = {};
  }
}

void SubmapBuilder::add_stored(int index, const KeyframeStore& store) {
  pass(store[index].since_last);
  begun_.push_back({index, since_stored_});
  since_stored_ = {};
}

void SubmapBuilder::resume(const Submap& last, const KeyframeStore& store) {
  has_origin_ = true;
  since_origin_ = {};
  for (int k = last.keyframes / 2 + 1; k < last.keyframes; ++k) {
    since_origin_ = since_origin_.then(store[last.first_keyframe + k].since_last);
  }
}

OdometryStretch SubmapBuilder::since_origin() const {
  OdometryStretch sum = since_origin_;
  for (const Begun& each : begun_) {
    sum = sum.then(each.since_last);
  }
  return sum.then(since_stored_);
}

bool SubmapBuilder::finish(KeyframeStore& store) {
  if (begun_.empty()) {
    return false;
  }
  const std::size_t middle = begun_.size() / 2;
  finished_ = make_submap(store, begun_.front().index, static_cast<int>(begun_.size()));
  odometry_ = has_origin_ ? since_origin_ : OdometryStretch{};
  since_origin_ = {};
  for (std::size_t i = 0; i < begun_.size(); ++i) {
    const Begun& each = begun_[i];
    OdometryStretch& sum = i <= middle ? odometry_ : since_origin_;
    sum = sum.then(each.since_last);
  }
  has_origin_ = true;
  begun_.clear();
  travel_m_ = slip_m_ = 0.0;
  return true;
}

}  // namespace odoless
