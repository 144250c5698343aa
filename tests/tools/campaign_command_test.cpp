#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/support/run_command.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/output/whole_file.hpp"

namespace odoless {
namespace {

using test::Outcome;
using test::run;
using ::testing::HasSubstr;

TEST(CampaignCommand, ListsItsRunsWithoutRunningThem) {
  const Outcome list = run({"campaign", "--runs", "300", "--seed", "7", "--list"});
  EXPECT_EQ(list.status, 0);
  EXPECT_EQ(std::ranges::count(list.out, '\n'), 300);
  EXPECT_THAT(list.out, HasSubstr("kidnapping"));
  EXPECT_TRUE(list.out.starts_with(run({"campaign", "--runs", "20", "--seed", "7", "--list"}).out));
  EXPECT_EQ(std::ranges::count(run({"campaign", "--gaps", "--list"}).out, '\n'), 192);
}

TEST(CampaignCommand, RefusesWhatMakesNoSense) {
  for (const auto& arguments : std::vector<std::vector<std::string>>{{"--runs", "0"},
                                                                     {"--kind", "nonsense"},
                                                                     {"--kind", "silence", "--gaps"},
                                                                     {"--runs", "5", "--only", "5"},
                                                                     {"--trace", "a.csv"},
                                                                     {"--figure", "a.jpg"}}) {
    std::vector<std::string> all{"campaign"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Outcome outcome = run(all);
    EXPECT_EQ(outcome.status, 64) << arguments.front();
    EXPECT_NE(outcome.err, "");
  }
}

// The exit status tells what the figures tell, whatever they are.
TEST(CampaignCommand, WritesOneRunAndItsTrace) {
  const test::TemporaryFolder folder;
  const std::string json_file = (folder.path() / "run.json").string();
  const std::string trace_file = (folder.path() / "run.csv").string();
  const Outcome outcome =
      run({"campaign", "--kind", "symmetric", "--only", "3", "--json", json_file, "--trace", trace_file});
  const auto json = nlohmann::json::parse(read_whole_file(json_file));
  EXPECT_EQ(json["runs"], 1);
  EXPECT_EQ(json["each"][0]["index"], 3);
  EXPECT_EQ(outcome.status, json["silent_failures"].get<int>());
  EXPECT_EQ(outcome.err.find("silent failure") != std::string::npos, outcome.status == 1);
  EXPECT_THAT(outcome.out, HasSubstr("symmetric"));
  EXPECT_GT(std::ranges::count(read_whole_file(trace_file), '\n'), json["each"][0]["scans"].get<int>());
}

}  // namespace
}  // namespace odoless
