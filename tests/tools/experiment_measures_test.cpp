#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"
#include "tests/tools/sim_support.hpp"
#include "tools/command/error.hpp"
#include "tools/experiment/builtin_files.hpp"
#include "tools/experiment/measures.hpp"
#include "tools/experiment/plots.hpp"
#include "tools/experiment/route.hpp"
#include "tools/experiment/scene.hpp"
#include "tools/experiment/self_fitness.hpp"
#include "tools/experiment/table.hpp"
#include "tools/output/map_files.hpp"
#include "tools/replay/replay.hpp"

namespace odoless {
namespace {

MatchRow match(int index, const Pose2& motion) {
  return {.reference_index = index - 1, .index = index, .reference_T_scan = motion};
}

TEST(DisplacementErrors, AreInTheSeedsAxes) {
  const std::vector<ReferencePose> truth{{0.0, {1.0, 2.0, 0.5}}, {0.2, Pose2{1.0, 2.0, 0.5} * Pose2{0.3, 0.0, 0.1}}};
  const auto errors = displacement_errors(std::vector{match(1, {0.25, 0.04, 0.12})}, truth);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_NEAR(errors[0].y_m, -0.05, 1e-12) << "delta y is along the heading: too little travel is negative";
  EXPECT_NEAR(errors[0].x_m, -0.04, 1e-12) << "delta x is to the right";
  EXPECT_NEAR(errors[0].yaw_rad, 0.02, 1e-12);
  EXPECT_NEAR(errors[0].translation_m(), std::hypot(0.05, 0.04), 1e-12);
}

TEST(Chain, OfTrueMotionsIsTheTruePath) {
  const SceneData scene = load_scene({.world = "symmetric.world", .lrf = {.rate_hz = 2.0}}, {});
  std::vector<MatchRow> matches;
  for (std::size_t i = 1; i < scene.truth.poses.size(); ++i) {
    matches.push_back(match(static_cast<int>(i), scene.truth.poses[i - 1].pose.inverse() * scene.truth.poses[i].pose));
  }
  const std::vector<double> errors_m = position_errors_m(chain(matches, scene.truth.poses[0].pose), scene.truth.poses);
  EXPECT_EQ(errors_m.size(), scene.log.scans.size());
  EXPECT_LT(*std::max_element(errors_m.begin(), errors_m.end()), 1e-9);
}

// The seed: it would be zero if the robot did not move and the laser did not err.
TEST(SeedFitness, IsZeroOfAScanMatchedWithItselfAndPositiveOfAnother) {
  const SceneData scene = load_scene({.world = "rooms.world", .lrf = {}, .scans_max = 12}, {});
  ScanLog twice = scene.log;
  twice.scans = {scene.log.scans[0], scene.log.scans[0], scene.log.scans[11]};
  const std::vector<MatchRow> matches = match_pairs(twice, {}, {}, [](std::int64_t, std::int64_t, double) {});
  const std::vector<double> fitness = seed_fitness(matches, self_scores(twice, {}));
  ASSERT_EQ(fitness.size(), 2U);
  EXPECT_NEAR(fitness[0], 0.0, 1.0);
  EXPECT_GT(fitness[1], 2.0);
}

TEST(RobustNormal, IsNotMovedByOutliers) {
  Rng rng(3);
  std::vector<double> values;
  for (int i = 0; i < 5000; ++i) {
    values.push_back(i % 20 == 0 ? 100.0 : 2.0 + 0.5 * rng.normal());
  }
  const RobustNormal law = fit_normal(values);
  EXPECT_NEAR(law.mean, 2.0, 0.05);
  EXPECT_NEAR(law.deviation, 0.5, 0.05);
}

TEST(RoomsRoute, VisitsThePlacesInTheSeedsOrder) {
  const SceneData scene = load_scene({.world = "rooms.world", .lrf = {}}, {});
  std::string letters;
  for (const Arrival& arrival : arrivals(scene.truth.poses, rooms_places())) {
    letters += arrival.letter;
  }
  EXPECT_EQ(letters, "ABCADBACBD");
}

TEST(Scene, IsCutAndItsKeyTellsWhatItDependsOn) {
  const Scene scene{.world = "rooms.world", .lrf = {}, .scans_max = 20};
  EXPECT_EQ(load_scene(scene, {}).log.scans.size(), 20U);
  Scene noisier = scene;
  noisier.lrf.noise_sd_m = 0.016;
  EXPECT_EQ(scene_key(scene, {}), scene_key(scene, {}));
  EXPECT_NE(scene_key(scene, {}), scene_key(noisier, {}));
  EXPECT_NE(scene_key(scene, {}), scene_key(scene, {.data = {}, .seed = 2}));
  EXPECT_NE(scene_key(scene, {}), scene_key({.world = "cave.world", .lrf = {}, .scans_max = 20}, {}));
}

TEST(Scene, NamesTheRecordedFileThatIsMissing) {
  const test::TemporaryFolder folder;
  folder.file("a.log", "x");
  Scene scene;
  scene.log = "a.log";
  EXPECT_EQ(missing_file(scene, {.data = folder.path()}), "");
  scene.reference = "b.tum";
  EXPECT_EQ(missing_file(scene, {.data = folder.path()}), "b.tum");
}

TEST(BuiltinFiles, AreThoseOfTheSourceTree) {
  for (const BuiltinFile& file : builtin_files()) {
    if (file.name.ends_with(".world")) {
      EXPECT_EQ(file.text, test::content_of(test::example_world(std::string(file.name)))) << file.name;
    }
  }
  EXPECT_NE(builtin_file("seed-simulated.toml").find("1500"), std::string_view::npos);
}

TEST(MapOfPoints, HasAnOccupiedCellWhereABeamEnded) {
  ScanLog log;
  log.scans.resize(1);
  log.scans[0].angle_step_rad = 1.5707963267948966;
  log.scans[0].ranges_m = {2.0F, 1.0F, std::numeric_limits<float>::infinity()};
  const OccupancyMap map = map_of_points(log, std::vector<Pose2>{{10.0, 0.0, 0.0}}, 0.1);
  int occupied = 0;
  for (int row = 0; row < map.height_cells; ++row) {
    for (int column = 0; column < map.width_cells; ++column) {
      occupied += map.at(column, row) == 100 ? 1 : 0;
    }
  }
  EXPECT_EQ(occupied, 2);
  EXPECT_NEAR(map.origin_x_m, 10.0, 1e-6);
  EXPECT_EQ(map.at(0, map.height_cells - 1), 100) << "the beam to the left, 1 m";
  EXPECT_EQ(map.at(map.width_cells - 1, 0), 100) << "the beam ahead, 2 m";
}

TEST(MapFiles, ReadBackWhatWasWritten) {
  const test::TemporaryFolder folder;
  const OccupancyMap map{.resolution_m = 0.04,
                         .origin_x_m = -1.5,
                         .origin_y_m = 2.25,
                         .width_cells = 3,
                         .height_cells = 2,
                         .occupancy_percent = {100, 0, -1, -1, 100, 0}};
  write_map(folder.path(), map);
  const OccupancyMap back = read_map(folder.path());
  EXPECT_EQ(back.occupancy_percent, map.occupancy_percent);
  EXPECT_EQ(back.width_cells, 3);
  EXPECT_EQ(back.height_cells, 2);
  EXPECT_DOUBLE_EQ(back.resolution_m, 0.04);
  EXPECT_DOUBLE_EQ(back.origin_x_m, -1.5);
  EXPECT_DOUBLE_EQ(back.origin_y_m, 2.25);
  folder.file("map.pgm", "P5\n3 2\n255\nabc");
  EXPECT_ANY_THROW(static_cast<void>(read_map(folder.path()))) << "a cut picture";
}

TEST(Table, IsCommaSeparatedUnderItsHeader) {
  EXPECT_EQ(format_csv({"t", {"a_m", "b_rad"}, {{1.0, 0.25}, {-2.0, 1e-7}}}), "a_m,b_rad\n1,0.25\n-2,1e-07\n");
}

TEST(Table, ReadsBackOrIsRefused) {
  const Table table = parse_csv("t", "a_m,b_rad\n1,0.25\n-2,1e-07\n");
  EXPECT_EQ(table.name, "t");
  EXPECT_EQ(table.columns, (std::vector<std::string>{"a_m", "b_rad"}));
  EXPECT_EQ(table.rows, (std::vector<std::vector<double>>{{1.0, 0.25}, {-2.0, 1e-7}}));
  EXPECT_THROW(static_cast<void>(parse_csv("t", "a_m,b_rad\n1\n")), DataError) << "a field is missing";
  EXPECT_THROW(static_cast<void>(parse_csv("t", "a_m,b_rad\n1,x\n")), DataError);
}

TEST(Figure, DrawsAPictureWithAxesOrAViewWithout) {
  const Canvas canvas(2, 1, {255, 0, 0});
  const Chart plan{.title = "plan", .picture = Underlay{canvas, 3.0, 4.0, 0.5}};
  const std::string with_axes = gnuplot_script({.name = "f", .panels = {plan}});
  EXPECT_NE(with_axes.find("\"f-1.png\" binary filetype=png dx=0.500000 dy=0.500000 origin=(3.250000,4.250000)"),
            std::string::npos)
      << "the middle of the lower left pixel";
  EXPECT_EQ(with_axes.find("unset tics"), std::string::npos);
  const std::string view = gnuplot_script({.name = "f", .panels = {{.picture = Underlay{.canvas = canvas}}}});
  EXPECT_NE(view.find("unset tics"), std::string::npos);
}

}  // namespace
}  // namespace odoless
