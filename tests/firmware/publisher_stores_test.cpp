#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/resource.h>

#include <csignal>
#include <utility>
#include <vector>

#include "firmware/publisher/map_store.hpp"
#include "firmware/publisher/pose_stream.hpp"
#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

constexpr int kTileSide_cells = 4;

std::vector<std::uint8_t> cells_from(std::uint8_t first) {
  std::vector<std::uint8_t> cells(kTileSide_cells * kTileSide_cells);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    cells[i] = static_cast<std::uint8_t>(first + i);
  }
  return cells;
}

MapTileRecord tile_at(int column, int row) {
  return {.column = column, .row = row, .size_cells = kTileSide_cells, .cell_size_m = 0.1};
}

TEST(MapStore, KnowsNothingUntilATileComes) {
  MapStore store({.resolution_m = 0.1, .columns = 16, .rows = 16});
  EXPECT_EQ(store.view(0).columns, 0);
  const OccupancyMap map = store.map();
  EXPECT_EQ(map.width_cells, 1) << "a save at the very start has its files too";
  EXPECT_EQ(map.height_cells, 1);
  ASSERT_EQ(map.occupancy_percent.size(), 1U);
  EXPECT_EQ(map.occupancy_percent[0], OccupancyMap::kUnknown);
}

TEST(MapStore, ShowsThePartThatIsKnownWhereItLies) {
  MapStore store({.resolution_m = 0.1, .columns = 16, .rows = 16});
  store.update(tile_at(0, 0), cells_from(0));
  store.update(tile_at(-1, 1), cells_from(50));
  const OccupancyMap map = store.map();
  EXPECT_EQ(map.width_cells, 8);
  EXPECT_EQ(map.height_cells, 8);
  EXPECT_NEAR(map.origin_x_m, -0.4, 1e-12);
  EXPECT_NEAR(map.origin_y_m, 0.0, 1e-12);
  EXPECT_EQ(map.occupancy_percent[4], 0);           // lower right: the first tile
  EXPECT_EQ(map.occupancy_percent[4 * 8 + 0], 50);  // upper left: the second
  EXPECT_EQ(map.occupancy_percent[4 * 8 + 4], -1);  // upper right: nothing is known
}

TEST(MapStore, ANewerTileReplacesTheOlder) {
  MapStore store({.resolution_m = 0.1, .columns = 16, .rows = 16});
  store.update(tile_at(0, 0), cells_from(0));
  store.update(tile_at(0, 0), cells_from(30));
  EXPECT_EQ(store.map().occupancy_percent[0], 30);
}

TEST(MapStore, FollowsTheTilesAndForgetsWhatIsFarthestFromTheLastOne) {
  MapStore store({.resolution_m = 0.1, .columns = 10, .rows = 10});  // tiles of 4 do not fill it
  for (int column = -3; column <= 1003; ++column) {
    store.update(tile_at(column, -column), cells_from(static_cast<std::uint8_t>(column % 10 + 20)));
  }
  const OccupancyMap map = store.map();
  ASSERT_EQ(map.width_cells, 10);
  ASSERT_EQ(map.height_cells, 10);
  EXPECT_NEAR(map.origin_x_m, 0.1 * (1004 * kTileSide_cells - 10), 1e-9);
  EXPECT_NEAR(map.origin_y_m, -0.1 * 1003 * kTileSide_cells, 1e-9);
  EXPECT_EQ(map.at(6, 0), 23);                // the last tile, at the lower right
  EXPECT_EQ(map.at(2, kTileSide_cells), 22);  // the one before
  EXPECT_EQ(map.at(0, 8), 21 + 2);            // a part of the one before that
  EXPECT_EQ(map.at(6, 8), -1) << "what was there is forgotten";
  EXPECT_EQ(map.at(0, 0), -1);
}

PoseRecord pose_of(std::int64_t stamp_ns, double x_m, std::int64_t update_stamp_ns, double since_update_m) {
  PoseRecord pose;
  pose.stamp_ns = stamp_ns;
  pose.map_T_scan = {x_m, 0, 0};
  pose.update_stamp_ns = update_stamp_ns;
  pose.update_T_scan = {since_update_m, 0, 0};
  return pose;
}

std::vector<StampedPose> all_of(PoseSpool& spool, PoseStream::Change change) {
  PoseStream stream(spool, spool.size(), std::move(change));
  std::vector<StampedPose> poses;
  for (std::span<const StampedPose> piece = stream.next(); !piece.empty(); piece = stream.next()) {
    poses.insert(poses.end(), piece.begin(), piece.end());
  }
  EXPECT_EQ(stream.error(), 0);
  EXPECT_EQ(poses.size(), stream.size());
  return poses;
}

TEST(PoseSpool, FinalPosesHangOnTheirUpdatesAndOnlineOnesStay) {
  const test::TemporaryFolder folder;
  PoseSpool spool(folder.path());
  spool.add(pose_of(10, 0.0, 10, 0.0));
  spool.add(pose_of(20, 0.5, 10, 0.5));
  spool.add(pose_of(30, 1.0, 30, 0.0));
  spool.add(pose_of(40, 1.5, 30, 0.5));
  const std::vector<StampedPose> final_poses = all_of(spool, take_final({{10, {5.0, 0, 0}}, {30, {7.0, 0, 0}}}));
  ASSERT_EQ(final_poses.size(), 4U);
  EXPECT_EQ(final_poses[1].map_T_scan.x_m, 5.5);
  EXPECT_EQ(final_poses[3].map_T_scan.x_m, 7.5);
  const std::vector<StampedPose> online = all_of(spool, take_online);
  ASSERT_EQ(online.size(), 4U);
  EXPECT_EQ(online[3].map_T_scan.x_m, 1.5);
  EXPECT_EQ(spool.error(), 0);
}

TEST(PoseSpool, PosesWhoseUpdateTheFilterForgotStayAsPublished) {
  const test::TemporaryFolder folder;
  PoseSpool spool(folder.path());
  spool.add(pose_of(20, 0.5, 10, 0.5));
  spool.add(pose_of(40, 1.5, 30, 0.5));
  const std::vector<StampedPose> final_poses = all_of(spool, take_final({{30, {7.0, 0, 0}}}));
  EXPECT_EQ(final_poses[0].map_T_scan.x_m, 0.5);
  EXPECT_EQ(final_poses[1].map_T_scan.x_m, 7.5);
}

TEST(PoseSpool, SaysWhyNothingCanBeKept) {
  EXPECT_EQ(PoseSpool("/nonexistent/folder").error(), ENOENT);
  PoseSpool none("");
  none.add(pose_of(10, 0, 10, 0));
  EXPECT_FALSE(none.is_kept());
  EXPECT_EQ(none.error(), 0);
  EXPECT_TRUE(all_of(none, take_online).empty());
}

// A limit of the file's size is a disk that is full and then is not.
TEST(PoseSpool, WritesWhatADiskDidNotTakeWhenThereIsRoom) {
  const test::TemporaryFolder folder;
  PoseSpool spool(folder.path());
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit full{.rlim_cur = 1000, .rlim_max = limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &full), 0);
  constexpr int kPoses = 500;
  for (int i = 0; i < kPoses; ++i) {
    spool.add(pose_of(i, i, i, 0.0));
  }
  EXPECT_EQ(spool.error(), EFBIG);
  EXPECT_EQ(spool.size(), 0U);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  const std::vector<StampedPose> poses = all_of(spool, take_online);
  std::signal(SIGXFSZ, before);
  EXPECT_EQ(spool.error(), 0);
  ASSERT_EQ(poses.size(), static_cast<std::size_t>(kPoses));
  for (int i = 0; i < kPoses; ++i) {
    EXPECT_EQ(poses[static_cast<std::size_t>(i)].map_T_scan.x_m, i);
  }
}

TEST(PoseStream, ADayAt40HzTakesNoMemory) {
  const test::TemporaryFolder folder;
  PoseSpool spool(folder.path());
  constexpr int kPoses = 24 * 3600 * 40;
  for (int i = 0; i < kPoses; ++i) {
    spool.add(pose_of(i, i, i, 0.0));
  }
  PoseStream stream(spool, spool.size(), take_online);
  EXPECT_EQ(stream.size(), static_cast<std::size_t>(kPoses));
  const auto heap_bytes = [] { return mallinfo2().uordblks + mallinfo2().hblkhd; };
  const std::size_t before_bytes = heap_bytes();
  int found = 0;
  for (std::span<const StampedPose> piece = stream.next(); !piece.empty(); piece = stream.next()) {
    for (const StampedPose& pose : piece) {
      ASSERT_EQ(pose.stamp_ns, found++);
    }
  }
  EXPECT_EQ(found, kPoses);
  EXPECT_LE(heap_bytes(), before_bytes);
}

}  // namespace
}  // namespace odoless
