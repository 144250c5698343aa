#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/parameters.hpp"
#include "core/cloud/voxel_table.hpp"
#include "core/geometry/pose2.hpp"
#include "core/geometry/pose3.hpp"

namespace odoless {

/// How a cloud is kept.
struct CloudParams {
  double voxel_m = 0.05;
  int points_max = 2'000'000;
  int keys_max = 4'096;
  int key_voxels_max = 262'144;
  double key_distance_m = 2.0;
  double key_rotation_rad = 1.5707963267948966;
  double range_max_m = 15.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("voxel_m", self.voxel_m, Range{0.005, 1.0}, "Side of a voxel; each voxel keeps one point.");
    visit.value("points_max", self.points_max, Range{1'000, 200'000'000},
                "Most points of the cloud, 16 bytes each; when it is full, new points are refused and counted.");
    visit.value("keys_max", self.keys_max, Range{1, 1'000'000}, "Most key poses of the cloud.");
    visit.value("key_voxels_max", self.key_voxels_max, Range{1'000, 16'777'216},
                "Most voxels of one key pose; memory is set aside for twice as many, 16 bytes each.");
    visit.value("key_distance_m", self.key_distance_m, Range{0.1, 100.0}, "Travel after which a new key pose begins.");
    visit.value("key_rotation_rad", self.key_rotation_rad, Range{0.05, 100.0},
                "Rotation after which a new key pose begins.");
    visit.value("range_max_m", self.range_max_m, Range{0.5, 200.0},
                "Largest range of a return that goes into the cloud.");
  }
};

/// The mean of the returns in a voxel, in its key's frame.
struct CloudPoint {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float z_m = 0.0F;
  std::uint32_t returns = 0;
};

/// A pose that points hang on: they follow it when it is corrected.
struct CloudKey {
  std::int64_t stamp_ns = 0;
  Pose2 map_T_key{};
  std::size_t first_point = 0;
};

/// A cloud of points in fixed memory. Points are kept in the frame of the pose that they were seen from, thinned to one
/// per voxel of that frame, so that a corrected trajectory moves them without touching them.
///
/// When the memory for points, for a key's voxels or for keys is full, what would need more is refused and counted;
/// what is there stays, and goes on to be averaged.
///
/// Thread:    owned by one thread.
/// Real time: no allocation after construction; `add` takes at most VoxelTable::kProbesMax steps, `correct` one.
class KeyedCloud {
 public:
  explicit KeyedCloud(const CloudParams& params);

  /// Points belong to a new key from now on. Where there is no room for one, points are refused from then on.
  void begin_key(std::int64_t stamp_ns, const Pose2& map_T_key);
  /// A return in the newest key's frame. False where it was refused.
  bool add(float x_m, float y_m, float z_m);
  /// Where a key is, as is known now.
  void correct(std::size_t key, const Pose2& map_T_key) { keys_[key].map_T_key = map_T_key; }
  void clear();

  [[nodiscard]] std::span<const CloudKey> keys() const { return keys_; }
  /// In the key's frame.
  [[nodiscard]] std::span<const CloudPoint> points_of(std::size_t key) const;
  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] std::int64_t refused() const { return refused_; }
  /// Share of the memory for points, or for keys where that is more, that is in use: 0 to 1.
  [[nodiscard]] double used() const;

 private:
  /// A known point's number, or the next one's where there is room for it.
  [[nodiscard]] std::optional<std::uint32_t> number_of(const Voxel& voxel);
  [[nodiscard]] Voxel voxel_of(float x_m, float y_m, float z_m) const;

  CloudParams params_;
  float voxels_per_m_;
  std::vector<CloudKey> keys_;
  std::vector<CloudPoint> points_;
  VoxelTable table_;  ///< of the newest key
  bool is_open_ = false;
  std::int64_t refused_ = 0;
};

/// Calls `visit(key, p_map, returns)` for every point, in the order in which they were first seen.
template <class Visit>
void for_each_point(const KeyedCloud& cloud, const Visit& visit) {
  for (std::size_t key = 0; key < cloud.keys().size(); ++key) {
    const Pose3 map_T_key = Pose3::of(cloud.keys()[key].map_T_key);
    for (const CloudPoint& point : cloud.points_of(key)) {
      visit(key, map_T_key * Point3{point.x_m, point.y_m, point.z_m}, point.returns);
    }
  }
}

}  // namespace odoless
