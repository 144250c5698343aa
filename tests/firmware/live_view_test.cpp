#include "firmware/web/live_view.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/rng.hpp"
#include "firmware/threads/tile_sweep.hpp"

namespace odoless {
namespace {

constexpr int kSide_cells = TileSweep::kSide_cells;
constexpr std::size_t kTileCells = std::size_t{kSide_cells} * kSide_cells;
constexpr std::int64_t kTick_ns = 100'000'000;

struct ViewEvent {
  std::string kind;
  std::string data;
};

std::vector<ViewEvent> events_in(std::string_view text) {
  std::vector<ViewEvent> events;
  while (!text.empty()) {
    const std::size_t end = text.find("\n\n");
    EXPECT_NE(end, std::string_view::npos) << "an event that does not end";
    const std::string_view block = text.substr(0, end);
    const std::size_t kind = block.find("event: ");
    const std::size_t data = block.find("\ndata: ");
    events.push_back({std::string(block.substr(kind + 7, data - kind - 7)), std::string(block.substr(data + 7))});
    text.remove_prefix(std::min(end + 2, text.size()));
  }
  return events;
}

/// What a page makes of runs, in plain words.
std::vector<std::uint8_t> levels_of_runs(std::string_view runs) {
  std::vector<std::uint8_t> levels;
  while (!runs.empty()) {
    const auto level = static_cast<std::uint8_t>(runs.front() - 'a');
    const std::size_t end = std::min(runs.find_first_not_of("0123456789", 1), runs.size());
    const std::string count(runs.substr(1, end - 1));
    levels.insert(levels.end(), count.empty() ? 1 : std::stoul(count), level);
    runs.remove_prefix(end);
  }
  return levels;
}

/// A view, somebody who publishes, and a browser.
class LiveViewTest : public ::testing::Test {
 protected:
  void publish_pose(double x_m, int map_number = 0) {
    PoseRecord pose;
    pose.stamp_ns = ++stamp_ns_;
    pose.map_T_scan.x_m = x_m;
    pose.map_number = map_number;
    view_.take(pose);
  }
  void publish_tile(int column, int row, std::uint8_t percent) {
    view_.take({.column = column, .row = row, .size_cells = kSide_cells, .cell_size_m = 0.05},
               std::vector<std::uint8_t>(kTileCells, percent));
  }
  void publish_noise(int column, int row) {
    std::vector<std::uint8_t> cells(kTileCells);
    std::generate(cells.begin(), cells.end(), [this] { return static_cast<std::uint8_t>(rng_.below(101)); });
    view_.take({.column = column, .row = row, .size_cells = kSide_cells, .cell_size_m = 0.05}, cells);
  }
  std::string tell(LiveCursor& cursor, std::int64_t passed_ns = kTick_ns) {
    now_ns_ += passed_ns;
    std::string text;
    view_.tell(cursor, now_ns_, text);
    return text;
  }
  std::vector<ViewEvent> told(LiveCursor& cursor, const std::string& kind, std::int64_t passed_ns = kTick_ns) {
    std::vector<ViewEvent> events = events_in(tell(cursor, passed_ns));
    std::erase_if(events, [&kind](const ViewEvent& event) { return event.kind != kind; });
    return events;
  }

  LiveView view_{{.resolution_m = 0.05, .columns = 10 * kSide_cells, .rows = 10 * kSide_cells}};
  Rng rng_{7};
  std::int64_t stamp_ns_ = 0;
  std::int64_t now_ns_ = 1;
};

TEST_F(LiveViewTest, TellsANewcomerAllAndThenOnlyWhatChanged) {
  publish_pose(1.0);
  publish_tile(0, 0, 0);
  publish_tile(-5, 4, 100);
  view_.take(DaemonStatus{});
  LiveCursor cursor;
  const std::vector<ViewEvent> first = events_in(tell(cursor));
  ASSERT_EQ(first.size(), 6U);
  EXPECT_EQ(first[0].kind, "map");
  EXPECT_EQ(nlohmann::json::parse(first[1].data)["state"], "INIT");
  EXPECT_EQ(nlohmann::json::parse(first[2].data)["x_m"], 1.0);
  EXPECT_EQ(nlohmann::json::parse(first[3].data)["points_cm"], nlohmann::json::parse("[100, 0]"));
  EXPECT_EQ(first[4].data, "0 0 a16384");
  EXPECT_EQ(first[5].data, "-5 4 p16384");
  EXPECT_EQ(tell(cursor), "") << "nothing is new";
  publish_tile(0, 0, 1);  // the same, as far as the page shows it
  EXPECT_EQ(tell(cursor), "");
  publish_tile(0, 0, 255);
  EXPECT_EQ(tell(cursor), "event: tile\ndata: 0 0 q16384\n\n");
}

TEST_F(LiveViewTest, ASlowOneIsToldTheNewestAlone) {
  LiveCursor cursor;
  for (int i = 0; i <= 1000; ++i) {
    publish_pose(0.001 * i);
    publish_tile(0, 0, static_cast<std::uint8_t>(i % 100));
  }
  std::vector<ViewEvent> events = events_in(tell(cursor));
  const auto count = [&events](const std::string& kind) {
    return std::count_if(events.begin(), events.end(), [&kind](const ViewEvent& event) { return event.kind == kind; });
  };
  EXPECT_EQ(count("pose"), 1);
  EXPECT_EQ(count("tile"), 1);
  EXPECT_EQ(nlohmann::json::parse(events[1].data)["x_m"], 1.0);
}

TEST_F(LiveViewTest, NobodyIsToldMoreThanTheRateAndEverybodyHasTheWholeMapInTheEnd) {
  constexpr double kSeconds = 20.0;
  LiveCursor cursor;
  std::vector<std::vector<std::uint8_t>> shown(100);
  std::size_t told_bytes = 0;
  for (int i = 0; i < static_cast<int>(kSeconds * 10.0); ++i) {
    publish_pose(0.1 * i);
    for (int tile = 0; tile < 100 && i < 100; tile += 10) {
      publish_noise(tile / 10 - 5, i % 10 - 5);
    }
    const std::string text = tell(cursor);
    told_bytes += text.size();
    EXPECT_LT(text.size(), 40'000U);
  }
  EXPECT_LT(static_cast<double>(told_bytes), 1.02 * LiveView::kRate_bytes_per_s * kSeconds + 20'000);
  LiveCursor another;
  std::vector<std::string> of_newcomer;
  std::vector<std::string> of_first;
  for (int i = 0; i < 200; ++i) {
    for (const ViewEvent& event : told(another, "tile")) {
      of_newcomer.push_back(event.data);
    }
  }
  EXPECT_EQ(of_newcomer.size(), 100U);
  for (const ViewEvent& event : told(cursor, "tile")) {
    of_first.push_back(event.data);
  }
  EXPECT_TRUE(of_first.empty()) << "ten seconds after the last change it has all";
}

TEST_F(LiveViewTest, AMapThatIsBegunAnewIsToldAsSuch) {
  LiveCursor cursor;
  publish_pose(3.0);
  publish_tile(0, 0, 100);
  static_cast<void>(tell(cursor));
  publish_pose(0.0, 1);
  const std::vector<ViewEvent> events = events_in(tell(cursor));
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(nlohmann::json::parse(events[0].data)["number"], 1);
  EXPECT_EQ(events[1].kind, "pose");
  EXPECT_EQ(nlohmann::json::parse(events[2].data)["from"], 0) << "the path too";
  LiveCursor newcomer;
  EXPECT_TRUE(told(newcomer, "tile").empty());
}

TEST_F(LiveViewTest, AChangeOfStateIsToldAtOnceAndElseTwiceASecond) {
  LiveCursor cursor;
  DaemonStatus status;
  view_.take(status);
  EXPECT_EQ(told(cursor, "state").size(), 1U);
  int times = 0;
  for (int i = 0; i < 10; ++i) {
    times += static_cast<int>(told(cursor, "state").size());
  }
  EXPECT_EQ(times, 2);
  status.health.state = HealthState::kLost;
  status.health.reasons = kReasonDiverged;
  view_.take(status);
  const std::vector<ViewEvent> events = told(cursor, "state", 1);
  ASSERT_EQ(events.size(), 1U);
  const auto json = nlohmann::json::parse(events[0].data);
  EXPECT_EQ(json["state"], "LOST");
  EXPECT_EQ(json["reasons"][0], "scans do not match the map");
}

TEST_F(LiveViewTest, ShowsAScanWhereItsPoseHasIt) {
  PoseRecord pose;
  pose.map_T_scan = {1.0, 2.0, 0.0};
  const std::vector<float> ranges_m{1.0F, 0.0F, std::numeric_limits<float>::infinity(), 2.0F};
  view_.take(pose, {.stamp_ns = 1'000'000'000, .start_angle_rad = 0.0, .angle_step_rad = std::numbers::pi / 6.0},
             ranges_m);
  LiveCursor cursor;
  const std::vector<ViewEvent> events = told(cursor, "scan");
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(nlohmann::json::parse(events[0].data)["points_cm"], nlohmann::json::parse("[200, 200, 100, 400]"));
}

TEST_F(LiveViewTest, ShowsTheRobotBehindALaserThatHangsUpsideDown) {
  PoseRecord pose;
  pose.map_T_scan = {1.0, 2.0, 0.0};
  pose.laser = {.x_m = 0.5, .is_flipped = true};
  view_.take(pose);
  view_.take(pose, {.stamp_ns = 1'000'000'000, .start_angle_rad = 0.0, .angle_step_rad = std::numbers::pi / 2.0},
             std::vector<float>{1.0F, 2.0F});
  LiveCursor cursor;
  const std::vector<ViewEvent> scans = told(cursor, "scan");
  ASSERT_EQ(scans.size(), 1U);
  EXPECT_EQ(nlohmann::json::parse(scans[0].data)["points_cm"], nlohmann::json::parse("[200, 200, 100, 0]"));
  LiveCursor other;
  const std::vector<ViewEvent> poses = told(other, "pose");
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_EQ(nlohmann::json::parse(poses[0].data)["x_m"], 0.5);
}

TEST_F(LiveViewTest, FollowsTheRobotHoweverFarAndKeepsTheNewestTiles) {
  for (int column = 0; column < 1000; ++column) {
    publish_tile(column, -column, 0);
  }
  LiveCursor cursor;
  std::vector<ViewEvent> tiles;
  for (int i = 0; i < 100; ++i) {
    const std::vector<ViewEvent> more = told(cursor, "tile");
    tiles.insert(tiles.end(), more.begin(), more.end());
  }
  ASSERT_EQ(tiles.size(), 11U);  // as many as the grid touches
  EXPECT_EQ(tiles.front().data, "989 -989 a16384");
  EXPECT_EQ(tiles.back().data, "999 -999 a16384");
}

TEST_F(LiveViewTest, TilesOfAnotherSizeAreLeftOut) {
  view_.take({.column = 0, .row = 0, .size_cells = 2}, std::vector<std::uint8_t>(4));
  LiveCursor cursor;
  EXPECT_TRUE(told(cursor, "tile").empty());
}

TEST(Trail, KeepsTheWholeWayInFewerAndFewerPoints) {
  Trail trail;
  for (int i = 0; i < 100'000; ++i) {
    trail.add({0.05 * i, 0.0});
  }
  TrailCursor cursor;
  const auto points = trail.next(cursor, 1'000'000);
  EXPECT_GT(points.size(), Trail::kPoints / 4);
  EXPECT_LE(points.size(), Trail::kPoints);
  EXPECT_EQ(points.front().x_m, 0.0);
  EXPECT_NEAR(points.back().x_m, 5000.0, 5.0);
  EXPECT_TRUE(trail.next(cursor, 10).empty());
  trail.add({6000.0, 0.0});
  EXPECT_EQ(trail.next(cursor, 10).size(), 1U);
  trail.clear();
  trail.add({1.0, 0.0});
  EXPECT_EQ(trail.next(cursor, 10).size(), 1U) << "of another edition it has nothing";
}

RC_GTEST_PROP(LiveViewRuns, GiveTheLevelsAgainAndAreNeverLonger, ()) {
  const auto levels = *rc::gen::container<std::vector<std::uint8_t>>(rc::gen::inRange<std::uint8_t>(0, 17));
  std::string text;
  append_runs(levels, text);
  RC_ASSERT(levels_of_runs(text) == levels);
  RC_ASSERT(text.size() <= levels.size());
}

TEST(LiveViewLevels, GoFromFreeToOccupiedAndUnknown) {
  EXPECT_EQ(level_of(0), 0);
  EXPECT_EQ(level_of(50), 8);
  EXPECT_EQ(level_of(100), 15);
  EXPECT_EQ(level_of(255), 16);
}

}  // namespace
}  // namespace odoless
