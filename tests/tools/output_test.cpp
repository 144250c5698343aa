#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "tests/support/temporary_folder.hpp"
#include "tools/command/error.hpp"
#include "tools/log/reference_poses.hpp"
#include "tools/odolessd/run_folder.hpp"
#include "tools/output/map_files.hpp"
#include "tools/output/matches.hpp"
#include "tools/output/result_folder.hpp"
#include "tools/output/sha256.hpp"
#include "tools/output/trajectory.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

using ::testing::HasSubstr;

int exit_code_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const UserError& error) {
    return error.exit_code();
  }
  return 0;
}

TEST(WholeFile, ReplacesWhatWasThereAndLeavesNothingElse) {
  const test::TemporaryFolder folder;
  const auto path = folder.file("a.txt", "a long old content");
  write_whole_file(path, "new");
  EXPECT_EQ(test::content_of(path), "new");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(WholeFile, SaysWhichFileFailed) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(exit_code_of([&] { write_whole_file(folder.path() / "no" / "a", "x"); }), 73);
  std::filesystem::create_directory(folder.path() / "folder");
  EXPECT_EQ(exit_code_of([&] { write_whole_file(folder.path() / "folder", "x"); }), 73);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "folder.tmp")) << "nothing half-written is left";
  std::filesystem::create_symlink("/dev/full", folder.path() / "b.tmp");
  EXPECT_EQ(exit_code_of([&] { write_whole_file(folder.path() / "b", "x"); }), 74);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "b"));
}

TEST(WholeFile, MakesFolders) {
  const test::TemporaryFolder folder;
  make_output_folder(folder.path() / "a" / "b");
  make_output_folder(folder.path() / "a" / "b");
  EXPECT_TRUE(std::filesystem::is_directory(folder.path() / "a" / "b"));
  const auto file = folder.file("file", "");
  EXPECT_EQ(exit_code_of([&] { make_output_folder(file); }), 73);
  EXPECT_EQ(exit_code_of([&] { make_output_folder(file / "under"); }), 73);
}

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  return names;
}

void write_results(ResultFolder& results, const std::string& content) {
  write_whole_file(results.unfinished() / "map.pgm", content);
  write_whole_file(results.unfinished() / kSummaryFile, content);
}

TEST(ResultFolder, AppearsWithAllItsFilesOrNotAtAll) {
  const test::TemporaryFolder folder;
  const std::filesystem::path out = folder.path() / "a" / "out";
  {
    ResultFolder given_up(out, false);
    write_results(given_up, "half");
    EXPECT_FALSE(std::filesystem::exists(out));
  }
  EXPECT_THAT(names_in(folder.path() / "a"), testing::IsEmpty()) << "nothing of it is left";
  ResultFolder results(out.string() + "/", false);
  write_results(results, "all");
  results.finish();
  EXPECT_THAT(names_in(folder.path() / "a"), testing::ElementsAre("out"));
  EXPECT_THAT(names_in(out), testing::UnorderedElementsAre("map.pgm", kSummaryFile));
}

TEST(ResultFolder, OverwritesNothingUnlessForced) {
  const test::TemporaryFolder folder;
  folder.file("summary.json", "of a run before");
  folder.file("matches.csv", "of a run before");
  folder.file("notes.txt", "a person's");
  EXPECT_EQ(exit_code_of([&] { ResultFolder(folder.path(), false); }), 73);
  EXPECT_EQ(exit_code_of([&] { ResultFolder(folder.path() / "notes.txt", true); }), 73);
  EXPECT_EQ(test::content_of(folder.path() / kSummaryFile), "of a run before");
  ResultFolder results(folder.path(), true);
  write_results(results, "new");
  EXPECT_EQ(test::content_of(folder.path() / kSummaryFile), "of a run before") << "until all is written";
  results.finish();
  EXPECT_EQ(test::content_of(folder.path() / kSummaryFile), "new");
  EXPECT_THAT(names_in(folder.path()), testing::UnorderedElementsAre("map.pgm", kSummaryFile, "notes.txt"));
}

// As an exported world's: no summary, and a trajectory of each session.
TEST(ResultFolder, ReplacesAWorldsResultsByOthers) {
  const test::TemporaryFolder folder;
  folder.file("trajectory_12.tum", "of an export before");
  folder.file("trajectory_mine.tum", "a person's");
  for (const char* const content : {"old", "new"}) {
    ResultFolder results(folder.path(), true);
    write_whole_file(results.unfinished() / "map.pgm", content);
    results.finish();
    EXPECT_EQ(test::content_of(folder.path() / "map.pgm"), content);
    EXPECT_THAT(names_in(folder.path()), testing::UnorderedElementsAre("map.pgm", "trajectory_mine.tum"));
  }
}

TEST(ResultFolder, TakesAnEmptyFolderAsItIs) {
  const test::TemporaryFolder folder;
  const std::filesystem::path out = folder.path() / "out";
  std::filesystem::create_directory(out);
  std::filesystem::permissions(out, std::filesystem::perms::owner_all);
  ResultFolder results(out, false);
  write_results(results, "new");
  results.finish();
  EXPECT_THAT(names_in(out), testing::UnorderedElementsAre("map.pgm", kSummaryFile));
  EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("out"));
}

TEST(ResultFolder, GivesWayWhereSomebodyElseWasFaster) {
  const test::TemporaryFolder folder;
  const std::filesystem::path out = folder.path() / "out";
  ResultFolder late(out, false);
  write_results(late, "late");
  std::filesystem::create_directory(out);
  write_whole_file(out / "map.pgm", "earlier");
  EXPECT_EQ(exit_code_of([&] { late.finish(); }), 73);
  EXPECT_EQ(test::content_of(out / "map.pgm"), "earlier");
}

TEST(ResultFolder, RemovesWhatAKilledProgramLeftAndNotWhatAnotherWrites) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / ".unfinished-1-0");
  write_whole_file(folder.path() / ".unfinished-1-0" / "map.pgm", "half");
  ResultFolder first(folder.path() / "first", false);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / ".unfinished-1-0"));
  ResultFolder second(folder.path() / "second", false);
  write_results(first, "first");
  write_results(second, "second");
  first.finish();
  second.finish();
  EXPECT_EQ(test::content_of(folder.path() / "first" / "map.pgm"), "first");
  EXPECT_EQ(test::content_of(folder.path() / "second" / "map.pgm"), "second");
}

TEST(RunFolder, KeepsTheLastSaveOfARunAloneEvenWhereSomebodyRemovedTheOneBefore) {
  const test::TemporaryFolder folder;
  RunFolder run(folder.path() / "out");
  const auto save = [&run] { return run.save([](const auto& path) { write_whole_file(path / kSummaryFile, "all"); }); };
  for (int i = 0; i < 10; ++i) {  // some of them within one second: they take one name
    const std::filesystem::path saved = save();
    EXPECT_EQ(test::content_of(saved / kSummaryFile), "all");
    EXPECT_THAT(names_in(folder.path() / "out"), testing::UnorderedElementsAre("latest", saved.filename().string()));
    if (i % 2 == 1) {
      std::filesystem::remove_all(saved);
    }
  }
}

TEST(Trajectory, IsTumWithExactStamps) {
  const std::vector<StampedPose> poses{
      {1'282'836'370'970'876'499, {1.5, -2.25, 0.0}}, {-1'500, {0, 0, std::numbers::pi / 2}}, {999'999'999, {}}};
  EXPECT_EQ(format_trajectory(poses),
            "1282836370.970876 1.500000 -2.250000 0 0 0 0.000000000 1.000000000\n"
            "-0.000002 0.000000 0.000000 0 0 0 0.707106781 0.707106781\n"
            "1.000000 0.000000 0.000000 0 0 0 0.000000000 1.000000000\n");
}

TEST(Trajectory, IsReadBackAsAReference) {
  const test::TemporaryFolder folder;
  std::vector<StampedPose> poses(100);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto at = static_cast<double>(i);
    poses[i] = {static_cast<std::int64_t>(i) * 200'000'000, {at * 0.1, -at * 0.2, wrap_angle(at * 0.3)}};
  }
  write_trajectory(folder.path() / "trajectory.tum", poses);
  const ReferencePoses back = read_reference_poses(folder.path() / "trajectory.tum");
  ASSERT_EQ(back.poses.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR(back.poses[i].stamp_s, static_cast<double>(poses[i].stamp_ns) * 1e-9, 1e-6);
    EXPECT_NEAR(back.poses[i].pose.distance_m(poses[i].map_T_scan), 0.0, 1e-6);
    EXPECT_NEAR(wrap_angle(back.poses[i].pose.yaw_rad - poses[i].map_T_scan.yaw_rad), 0.0, 1e-6);
  }
}

TEST(Matches, AreReadBack) {
  const test::TemporaryFolder folder;
  const MatchRow row{.reference_index = 3,
                     .index = 8,
                     .reference_stamp_s = 1282836370.970876,
                     .stamp_s = 1282836371.071704,
                     .reference_T_scan = {0.25, -0.125, 1.5},
                     .fitness = 0.875,
                     .evaluations = 5000,
                     .time_us = 1234.5,
                     .converged = true};
  write_matches(folder.path() / "matches.csv", std::vector{row, MatchRow{}});
  const auto rows = read_matches(folder.path() / "matches.csv");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].reference_index, 3);
  EXPECT_EQ(rows[0].index, 8);
  EXPECT_EQ(rows[0].reference_stamp_s, row.reference_stamp_s);
  EXPECT_EQ(rows[0].stamp_s, row.stamp_s);
  EXPECT_EQ(rows[0].reference_T_scan.x_m, 0.25);
  EXPECT_EQ(rows[0].reference_T_scan.y_m, -0.125);
  EXPECT_EQ(rows[0].reference_T_scan.yaw_rad, 1.5);
  EXPECT_EQ(rows[0].fitness, 0.875);
  EXPECT_EQ(rows[0].evaluations, 5000);
  EXPECT_EQ(rows[0].time_us, 1234.5);
  EXPECT_TRUE(rows[0].converged);
  EXPECT_FALSE(rows[1].converged);
}

TEST(Matches, HaveTheAgreedHeader) {
  EXPECT_EQ(
      format_matches({}),
      "reference_index,index,reference_stamp_s,stamp_s,dx_m,dy_m,dyaw_rad,fitness,evaluations,time_us,converged\n");
}

TEST(Matches, RefuseWhatIsMalformed) {
  const test::TemporaryFolder folder;
  const std::string header = format_matches({});
  for (const std::string& text :
       {std::string(), std::string("index\n"), header + "1,2,3\n", header + "1,2,0,0,0,0,x,0,0,0,1\n",
        header + "1,2,0,0,0,0,0,0,0,0,2\n", header + "-1,2,0,0,0,0,0,0,0,0,1\n", header + "1,2,0,0,0,0,0,0,0,0,1,5\n",
        header + "1,2,0,0,0,0,nan,0,0,0,1\n"}) {
    EXPECT_THROW(static_cast<void>(read_matches(folder.file("m.csv", text))), DataError) << text;
  }
  EXPECT_THROW(static_cast<void>(read_matches("/nonexistent")), NoInputError);
}

OccupancyMap small_map() {
  return {.resolution_m = 0.05,
          .origin_x_m = -1.5,
          .origin_y_m = 2.25,
          .width_cells = 3,
          .height_cells = 2,
          .occupancy_percent = {0, 100, -1, 25, 50, 65}};
}

TEST(MapFiles, PutTheHighestRowFirst) {
  const test::TemporaryFolder folder;
  write_map(folder.path(), small_map());
  EXPECT_EQ(test::content_of(folder.path() / "map.pgm"),
            "P5\n3 2\n255\n\xfe\xcd" + std::string(1, '\0') + "\xfe" + std::string(1, '\0') + "\xcd");
  const std::string yaml = test::content_of(folder.path() / "map.yaml");
  EXPECT_THAT(yaml, HasSubstr("image: map.pgm\n"));
  EXPECT_THAT(yaml, HasSubstr("resolution: 0.050000\n"));
  EXPECT_THAT(yaml, HasSubstr("origin: [-1.500000, 2.250000, 0.0]\n"));
}

TEST(MapFiles, ReadBackAsWhatTheyWereByTheirOwnThresholds) {
  const std::string yaml = format_map_yaml(small_map(), "map.pgm");
  EXPECT_THAT(yaml, HasSubstr("negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\nmode: trinary\n"));
  const auto occupancy = [](int grey) { return (255 - grey) / 255.0; };
  EXPECT_GT(occupancy(0), 0.65);
  EXPECT_LT(occupancy(254), 0.196);
  EXPECT_GT(occupancy(205), 0.196);
  EXPECT_LT(occupancy(205), 0.65);
}

TEST(Sha256, AgreesWithThePublishedVectors) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(sha256_of_file(folder.file("abc", "abc")),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_of_file(folder.file("none", "")),
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_of_file(folder.file("million", std::string(1'000'000, 'a'))),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  EXPECT_THROW(static_cast<void>(sha256_of_file("/nonexistent")), NoInputError);
}

}  // namespace
}  // namespace odoless
