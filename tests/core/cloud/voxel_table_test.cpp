#include "core/cloud/voxel_table.hpp"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

Voxel random_voxel(Rng& rng, std::int32_t reach) {
  const auto index = [&] {
    return static_cast<std::int32_t>(rng.below(static_cast<std::uint32_t>(2 * reach))) - reach;
  };
  return {index(), index(), index()};
}

// Half full, against a map: the same numbers, none lost, none refused.
TEST(VoxelTable, IsAMapUntilItIsHalfFull) {
  Rng rng(1);
  constexpr int kVoxels = 20'000;
  VoxelTable table(kVoxels);
  for (int round = 0; round < 3; ++round) {
    std::map<std::tuple<int, int, int>, std::uint32_t> plain;
    for (int i = 0; i < 60'000 && plain.size() < kVoxels; ++i) {
      const Voxel voxel = random_voxel(rng, 25);
      const auto number = static_cast<std::uint32_t>(plain.size());
      const auto [known, is_new] = plain.try_emplace({voxel.x, voxel.y, voxel.z}, number);
      EXPECT_EQ(table.find(voxel), is_new ? std::nullopt : std::optional(known->second));
      ASSERT_EQ(table.find_or_add(voxel, number), known->second);
      ASSERT_EQ(table.size(), plain.size());
    }
    table.clear();
    EXPECT_EQ(table.size(), 0U);
    EXPECT_EQ(table.find({0, 0, 0}), std::nullopt);
  }
}

TEST(VoxelTable, KeepsWhatItHasWhenItIsFull) {
  VoxelTable table(8);  // 16 places
  std::vector<Voxel> kept;
  for (std::int32_t x = 0; x < 100; ++x) {
    if (table.find_or_add({x, 0, 0}, static_cast<std::uint32_t>(x))) {
      kept.push_back({x, 0, 0});
    }
  }
  EXPECT_EQ(kept.size(), 16U);
  EXPECT_EQ(table.size(), 16U);
  for (const Voxel& voxel : kept) {
    EXPECT_EQ(table.find(voxel), static_cast<std::uint32_t>(voxel.x));
    EXPECT_EQ(table.find_or_add(voxel, 999), static_cast<std::uint32_t>(voxel.x));
  }
  EXPECT_EQ(table.find({99, 1, 1}), std::nullopt);
}

TEST(VoxelTable, RefusesWhatIsOutOfReach) {
  constexpr std::int32_t kReach = VoxelTable::kReach_voxels;
  VoxelTable table(100);
  EXPECT_EQ(table.find_or_add({kReach, 0, 0}, 1), std::nullopt);
  EXPECT_EQ(table.find_or_add({0, -kReach - 1, 0}, 1), std::nullopt);
  EXPECT_EQ(table.find_or_add({0, 0, INT32_MAX}, 1), std::nullopt);
  EXPECT_EQ(table.find_or_add({kReach - 1, -kReach, 0}, 7), 7U);
  EXPECT_EQ(table.find({kReach - 1, -kReach, 0}), 7U);
}

}  // namespace
}  // namespace odoless
