#include "core/cloud/keyed_cloud.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/check.hpp"

namespace odoless {

KeyedCloud::KeyedCloud(const CloudParams& params)
    : params_(params), voxels_per_m_(static_cast<float>(1.0 / params.voxel_m)), table_(params.key_voxels_max) {
  ODOLESS_CHECK(parameters_in_range(params));
  keys_.reserve(static_cast<std::size_t>(params.keys_max));
  points_.reserve(static_cast<std::size_t>(params.points_max));
}

void KeyedCloud::begin_key(std::int64_t stamp_ns, const Pose2& map_T_key) {
  is_open_ = keys_.size() < static_cast<std::size_t>(params_.keys_max);
  if (is_open_) {
    keys_.push_back({stamp_ns, map_T_key, points_.size()});
    table_.clear();
  }
}

// What is far out of the table's reach, and no number at all, comes to its edge, where it is refused.
Voxel KeyedCloud::voxel_of(float x_m, float y_m, float z_m) const {
  const auto index = [this](float value_m) {
    constexpr auto kReach = static_cast<float>(VoxelTable::kReach_voxels);
    const float scaled = std::floor(value_m * voxels_per_m_);
    return static_cast<std::int32_t>(scaled >= -kReach && scaled < kReach ? scaled : kReach);
  };
  return {index(x_m), index(y_m), index(z_m)};
}

std::optional<std::uint32_t> KeyedCloud::number_of(const Voxel& voxel) {
  if (!is_open_) {
    return std::nullopt;
  }
  const bool has_room = points_.size() < static_cast<std::size_t>(params_.points_max) &&
                        table_.size() < static_cast<std::size_t>(params_.key_voxels_max);
  return has_room ? table_.find_or_add(voxel, static_cast<std::uint32_t>(points_.size())) : table_.find(voxel);
}

bool KeyedCloud::add(float x_m, float y_m, float z_m) {
  const std::optional<std::uint32_t> number = number_of(voxel_of(x_m, y_m, z_m));
  if (!number) {
    ++refused_;
    return false;
  }
  if (*number == points_.size()) {
    points_.push_back({x_m, y_m, z_m, 1});
    return true;
  }
  CloudPoint& point = points_[*number];
  ++point.returns;
  const float share = 1.0F / static_cast<float>(point.returns);
  point.x_m += share * (x_m - point.x_m);
  point.y_m += share * (y_m - point.y_m);
  point.z_m += share * (z_m - point.z_m);
  return true;
}

std::span<const CloudPoint> KeyedCloud::points_of(std::size_t key) const {
  const std::size_t first = keys_[key].first_point;
  const std::size_t end = key + 1 < keys_.size() ? keys_[key + 1].first_point : points_.size();
  return {points_.data() + first, end - first};
}

void KeyedCloud::clear() {
  keys_.clear();
  points_.clear();
  table_.clear();
  is_open_ = false;
}

double KeyedCloud::used() const {
  return std::max(static_cast<double>(points_.size()) / params_.points_max,
                  static_cast<double>(keys_.size()) / params_.keys_max);
}

}  // namespace odoless
