#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <barrier>
#include <fstream>
#include <set>
#include <stdexcept>

#include "tests/support/run_command.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/experiment/campaign.hpp"
#include "tools/experiment/html_report.hpp"
#include "tools/experiment/task_pool.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr auto kNoProgress = [](double, int) {};

TEST(TaskPool, DoesEveryTaskOnceTheCostliestFirst) {
  std::vector<int> order;
  std::vector<Task> tasks;
  for (const int cost : {1, 3, 2}) {
    tasks.push_back({static_cast<double>(cost), [&order, cost](const ShareDone&) { order.push_back(cost); }});
  }
  run_tasks(std::move(tasks), 1, kNoProgress);
  EXPECT_THAT(order, ElementsAre(3, 2, 1));
}

TEST(TaskPool, UsesItsThreadsAtTheSameTime) {
  std::barrier meeting(2);  // one thread alone would wait here for ever
  std::vector<Task> tasks(2, {1.0, [&](const ShareDone&) { meeting.arrive_and_wait(); }});
  run_tasks(std::move(tasks), 2, kNoProgress);
}

TEST(TaskPool, SumsTheCostDoneUpToAll) {
  std::vector<Task> tasks(4, {2.5, [](const ShareDone& done) { done(0.5); }});
  double last_s = 0.0;
  int finished = 0;
  run_tasks(std::move(tasks), 2, [&](double cost_s, int count) {
    EXPECT_GE(cost_s, last_s);
    last_s = cost_s;
    finished = count;
  });
  EXPECT_DOUBLE_EQ(last_s, 10.0);
  EXPECT_EQ(finished, 4);
}

TEST(TaskPool, PassesAFailureOnAndBeginsNothingMore) {
  int begun = 0;
  std::vector<Task> tasks(5, {1.0, [&](const ShareDone&) {
                                ++begun;
                                throw std::runtime_error("no");
                              }});
  EXPECT_THROW(run_tasks(std::move(tasks), 1, kNoProgress), std::runtime_error);
  EXPECT_EQ(begun, 1);
}

Findings conclude(const Evidence& evidence) {
  const RunOutput output = evidence.output(evidence.runs().front().name);
  Series series{"fitness <of> a \"match\"", Mark::kLine, kRed, {}};
  Table table{"fitness", {"scan", "fitness"}, {}};
  for (const MatchRow& match : output.matches) {
    series.points.push_back({static_cast<double>(match.index), match.fitness});
    table.rows.push_back({static_cast<double>(match.index), match.fitness});
  }
  return {{{"0.1", "a < b & c", "a = 1", true}},
          {{.name = "plot",
            .caption = "A <plot>",
            .panels = {{.title = "t", .x_label = "scan", .y_label = "fitness", .series = {series}}}}},
          {table}};
}

/// An experiment of a second.
Experiment small_experiment() {
  Run run;
  run.name = "small";
  run.scene = {.world = "symmetric.world", .lrf = {.rate_hz = 2.0}, .scans_max = 6};
  return {"small", "0.1", "A small one", {run}, conclude};
}

class Campaign : public ::testing::Test {
 protected:
  [[nodiscard]] std::vector<Record> run(const std::string& out, std::uint64_t seed = 1, int threads = 2) const {
    static const std::vector<Experiment> experiments{small_experiment()};
    return conduct(experiments,
                   {.sources = {.data = {}, .seed = seed}, .out = folder_.path() / out, .threads = threads});
  }
  [[nodiscard]] std::string content(const std::string& path) const { return read_whole_file(folder_.path() / path); }

  test::TemporaryFolder folder_;
};

TEST_F(Campaign, WritesTableFigureAndClaims) {
  const std::vector<Record> records = run("a");
  ASSERT_EQ(records.size(), 1U);
  ASSERT_EQ(records[0].claims.size(), 1U);
  EXPECT_EQ(records[0].claims[0].stated, "a < b & c");
  EXPECT_TRUE(records[0].claims[0].agrees);
  EXPECT_THAT(content("a/small/fitness.csv"), HasSubstr("scan,fitness\n1,0."));
  const std::string svg = content("a/small/plot.svg");
  EXPECT_THAT(svg, HasSubstr("<svg"));
  EXPECT_THAT(svg, HasSubstr("</svg>"));
  EXPECT_THAT(svg, HasSubstr("fitness &lt;of> a")) << "the legend";
  EXPECT_EQ(content("a/small/plot.png").substr(1, 3), "PNG");
}

TEST_F(Campaign, GivesTheSameBytesWithTheSameSeedWhateverTheThreads) {
  static_cast<void>(run("a", 1, 1));
  static_cast<void>(run("b", 1, 4));
  static_cast<void>(run("c", 2, 1));
  for (const char* name : {"fitness.csv", "plot.svg", "plot.png", "plot.gp", "result.json"}) {
    EXPECT_EQ(content(std::string("a/small/") + name), content(std::string("b/small/") + name)) << name;
  }
  EXPECT_NE(content("a/small/fitness.csv"), content("c/small/fitness.csv"));
}

TEST_F(Campaign, DoesNotDoAgainWhatIsFinished) {
  static_cast<void>(run("a"));
  const std::filesystem::path matches = folder_.path() / "a/runs/small/matches.csv";
  const std::filesystem::path table = folder_.path() / "a/small/fitness.csv";
  std::ofstream(table) << "touched";
  std::ofstream(matches, std::ios::app) << "\n";
  static_cast<void>(run("a"));
  EXPECT_EQ(content("a/small/fitness.csv"), "touched");
  static_cast<void>(run("a", 2));
  EXPECT_NE(content("a/small/fitness.csv"), "touched") << "another seed is another input";
}

TEST_F(Campaign, ResumesWhereItWasInterrupted) {
  static_cast<void>(run("a"));
  const std::string table = content("a/small/fitness.csv");
  const auto made = std::filesystem::last_write_time(folder_.path() / "a/runs/small/matches.csv");
  std::filesystem::remove(folder_.path() / "a/small/key.txt");  // interrupted while it drew
  std::filesystem::remove(folder_.path() / "a/small/fitness.csv");
  static_cast<void>(run("a"));
  EXPECT_EQ(content("a/small/fitness.csv"), table);
  EXPECT_EQ(std::filesystem::last_write_time(folder_.path() / "a/runs/small/matches.csv"), made);
  std::filesystem::remove(folder_.path() / "a/runs/small/key.txt");  // interrupted while it matched
  std::ofstream(folder_.path() / "a/runs/small/matches.csv") << "half a li";
  std::filesystem::remove(folder_.path() / "a/small/key.txt");
  static_cast<void>(run("a"));
  EXPECT_EQ(content("a/small/fitness.csv"), table);
}

TEST_F(Campaign, SaysWhichLogIsAbsentAndGoesOn) {
  Experiment recorded = small_experiment();
  recorded.name = "recorded";
  recorded.runs[0].name = "recorded";
  recorded.runs[0].scene = {};
  recorded.runs[0].scene.log = "none.log";
  const std::vector<Experiment> experiments{recorded, small_experiment()};
  const std::vector<Record> records =
      conduct(experiments, {.sources = {.data = folder_.path()}, .out = folder_.path() / "d", .threads = 1});
  EXPECT_EQ(records[0].missing, "none.log");
  EXPECT_TRUE(records[0].claims.empty());
  EXPECT_EQ(records[1].claims.size(), 1U);
  const std::string html = html_report(records, folder_.path() / "d");
  EXPECT_THAT(html, HasSubstr("not run: none.log"));
}

TEST_F(Campaign, ReportIsOneFileWithEscapedTextAndEveryFigure) {
  const std::string html = html_report(run("a"), folder_.path() / "a");
  EXPECT_THAT(html, HasSubstr("a &lt; b &amp; c"));
  EXPECT_THAT(html, HasSubstr("data:image/svg+xml;base64,PD94bWw"));
  EXPECT_THAT(html, HasSubstr("A &lt;plot&gt;"));
  EXPECT_THAT(html, Not(HasSubstr("src=\"plot")));
}

TEST(ExperimentCommand, RefusesAnUnknownNameAndListsThoseThereAre) {
  const test::TemporaryFolder folder;
  const test::Outcome refused = test::run({"experiment", "no-such", "--out", folder.path().string()});
  EXPECT_EQ(refused.status, 64);
  const test::Outcome help = test::run({"experiment", "--help"});
  EXPECT_EQ(help.status, 0);
  for (const Experiment& experiment : all_experiments(Extent::kFull)) {
    EXPECT_THAT(help.out, HasSubstr(experiment.name));
  }
}

TEST(AllExperiments, HaveNamesOfTheirOwnAndCoverTheSeedsFigures) {
  for (const Extent extent : {Extent::kFull, Extent::kQuick}) {
    std::set<std::string> names;
    for (const Experiment& experiment : all_experiments(extent)) {
      EXPECT_TRUE(names.insert(experiment.name).second) << experiment.name;
      EXPECT_FALSE(experiment.runs.empty()) << experiment.name;
      EXPECT_NE(experiment.conclude, nullptr) << experiment.name;
    }
  }
}

}  // namespace
}  // namespace odoless
