#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "drivers/io/file_descriptor.hpp"
#include "tests/support/run_command.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/output/matches.hpp"

namespace odoless {
namespace {

using test::Outcome;
using test::run;
using ::testing::HasSubstr;

constexpr const char* kLog =
    "FLASER 4 1 2 0 81.91 0 0 0 0 0 0 10 h 0\nFLASER 4 3 4 5 81.91 1 0 0 0 0 0 10.5 h 0\nFLASER 4 3 4 5 6 1 1 0 0 0 0 "
    "11 h 0\n";

TEST(Command, SaysWhatItCanDo) {
  const Outcome help = run({"--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_THAT(help.out, HasSubstr("info"));
  EXPECT_THAT(help.out, HasSubstr("eval"));
  const Outcome version = run({"--version"});
  EXPECT_EQ(version.status, 0);
  EXPECT_THAT(version.out, ::testing::MatchesRegex("odoless [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST(Command, RefusesWrongUsage) {
  for (const auto& arguments :
       std::vector<std::vector<std::string>>{{},
                                             {"nonsense"},
                                             {"info"},
                                             {"info", "a", "b"},
                                             {"info", "--nonsense", "a"},
                                             {"eval"},
                                             {"eval", "ate", "a"},
                                             {"eval", "pairs", "a", "b", "--gross-m", "-1"},
                                             {"eval", "ate", "a", "b", "--tolerance-s", "soon"}}) {
    std::vector<const char*> argv{"odoless"};
    for (const std::string& argument : arguments) {
      argv.push_back(argument.c_str());
    }
    testing::internal::CaptureStderr();
    EXPECT_EQ(run_command_line(static_cast<int>(argv.size()), argv.data()), 64);
    EXPECT_NE(testing::internal::GetCapturedStderr(), "");
  }
}

TEST(Command, NamesTheCommandThatAMisspelledOneMeant) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> meant{
      {{"relpay", "a.log"}, "'relpay' is no command; did you mean replay?"},
      {{"infos"}, "did you mean info?"},
      {{"emulate", "lfr"}, "'lfr' is no command; did you mean lrf?"},
      {{"config", "refrence"}, "did you mean reference?"},
      {{"dance"}, "'dance' is no command; there are replay, match, cloud, "}};
  for (const auto& [arguments, said] : meant) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 64) << said;
    EXPECT_THAT(outcome.err, HasSubstr(said));
    EXPECT_EQ(outcome.out, "");
  }
}

TEST(Command, CtlSaysWhoseSocketItIsThatAUserMayNotUse) {
  if (::geteuid() == 0) {
    GTEST_SKIP() << "root may use any";
  }
  const test::TemporaryFolder folder;
  const std::string path = (folder.path() / "control").string();
  const FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof(address.sun_path) - 1);
  ASSERT_EQ(::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  ASSERT_EQ(::chmod(path.c_str(), 0060), 0);
  const Outcome outcome = run({"ctl", "--socket", path, "status"});
  EXPECT_EQ(outcome.status, 69);
  EXPECT_THAT(outcome.err, HasSubstr("it belongs to the group "));
}

// A script whose variable is empty does not mean what is built in.
TEST(Command, RefusesAnEmptyValue) {
  for (const auto& arguments : std::vector<std::vector<std::string>>{{"replay", "a.log", "--out", "b", "--config", ""},
                                                                     {"replay", "a.log", "--out", ""},
                                                                     {"info", ""},
                                                                     {"info", "--config="},
                                                                     {"memory", ""},
                                                                     {"ctl", "--config", "", "status"},
                                                                     {"ctl", "--socket", "", "status"},
                                                                     {"ctl", ""},
                                                                     {"emulate", "robot", "--from-raw", ""}}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 64) << arguments[0];
    EXPECT_NE(outcome.err, "") << arguments[0];
  }
}

TEST(Command, CtlTakesOneLineThatIsNotTooLong) {
  for (const std::string& command : {std::string("status\nstop"), std::string(1025, 'x')}) {
    const Outcome outcome = run({"ctl", "--socket", "/nowhere", command});
    EXPECT_EQ(outcome.status, 64);
    EXPECT_THAT(outcome.err, HasSubstr("one line of at most 1024 bytes"));
  }
}

TEST(Command, InfoTellsWhatALogHolds) {
  const test::TemporaryFolder folder;
  const std::string log = folder.file("a.log", kLog).string();
  const Outcome text = run({"info", log});
  EXPECT_EQ(text.status, 0);
  EXPECT_THAT(text.out, HasSubstr("CARMEN FLASER"));
  EXPECT_THAT(text.out, HasSubstr("sweep     not told"));
  const auto json = nlohmann::json::parse(run({"info", "--json", log}).out);
  EXPECT_EQ(json["scans"], 3);
  EXPECT_EQ(json["beams_min"], 4);
  EXPECT_EQ(json["beams_max"], 4);
  EXPECT_NEAR(json["angle_max_rad"], 1.5707963, 1e-6);
  EXPECT_EQ(json["has_stamps"], true);
  EXPECT_DOUBLE_EQ(json["duration_s"], 1.0);
  EXPECT_DOUBLE_EQ(json["rate_hz"], 2.0);
  EXPECT_DOUBLE_EQ(json["return_share"], 9.0 / 12.0);
  EXPECT_DOUBLE_EQ(json["no_return_share"], 2.0 / 12.0);
  EXPECT_DOUBLE_EQ(json["invalid_share"], 1.0 / 12.0);
  EXPECT_DOUBLE_EQ(json["range_min_m"], 1.0);
  EXPECT_DOUBLE_EQ(json["range_median_m"], 4.0);
  EXPECT_DOUBLE_EQ(json["range_max_m"], 6.0);
}

TEST(Command, InfoTellsHowLongASweepTakesWhereTheLogDoes) {
  const test::TemporaryFolder folder;
  const std::string log =
      folder.file("a.csv", "1,-1,0.5,0.025,0.1,0.1,10,4,1,2,3,4\n2,-1,0.5,0.025,0.1,0.1,10,4,1,2,3,4\n").string();
  EXPECT_THAT(run({"info", log}).out, HasSubstr("sweep     100.0 ms"));
  EXPECT_DOUBLE_EQ(nlohmann::json::parse(run({"info", "--json", log}).out)["sweep_s"], 0.1);
}

TEST(Command, NamesFileLineAndRemedyOfBadInput) {
  const test::TemporaryFolder folder;
  const Outcome bad = run({"info", folder.file("bad.log", std::string(kLog) + "FLASER 5 1\n").string()});
  EXPECT_EQ(bad.status, 65);
  EXPECT_THAT(bad.err, HasSubstr("bad.log:4: "));
  EXPECT_THAT(bad.err, HasSubstr("expected"));
  EXPECT_EQ(bad.out, "");
  EXPECT_EQ(run({"info", "/nonexistent"}).status, 66);
  EXPECT_EQ(run({"eval", "relations", "/nonexistent", "/nonexistent"}).status, 66);
}

TEST(Command, EvalMeasuresFiles) {
  const test::TemporaryFolder folder;
  const std::string log = folder.file("a.log", kLog).string();
  const std::string trajectory = folder.file("t", "10 5 5 0\n10.5 6 5 0\n11 6 6.1 0\n").string();
  const std::string relations =
      folder.file("r", "10 10.5 1 0 0 0 0 0\n10.5 11 0 1 0 0 0 0\n9 11 0 1 0 0 0 0\n").string();
  const auto measured = nlohmann::json::parse(run({"eval", "relations", relations, trajectory, "--json"}).out);
  EXPECT_EQ(measured["used"], 2);
  EXPECT_EQ(measured["missing"], 1);
  EXPECT_NEAR(measured["translation_m"]["mean"], 0.05, 1e-9);
  EXPECT_EQ(measured["one_visit"]["used"], 2);
  EXPECT_EQ(measured["across_loops"]["off"], 0);
  const auto ate = nlohmann::json::parse(run({"eval", "ate", log, trajectory, "--json"}).out);
  EXPECT_EQ(ate["used"], 3);
  EXPECT_LT(ate["translation_m"]["max"], 0.1);
  const MatchRow row{
      .reference_index = 0, .index = 1, .reference_stamp_s = 10, .stamp_s = 10.5, .reference_T_scan = {1.01, 0, 0}};
  write_matches(folder.path() / "m.csv", std::vector{row});
  const auto pairs =
      nlohmann::json::parse(run({"eval", "pairs", log, (folder.path() / "m.csv").string(), "--json"}).out);
  EXPECT_EQ(pairs["used"], 1);
  EXPECT_NEAR(pairs["translation_m"]["rmse"], 0.01, 1e-9);
  EXPECT_EQ(pairs["gross_failures"], 0);
  const auto strict = nlohmann::json::parse(
      run({"eval", "pairs", log, (folder.path() / "m.csv").string(), "--json", "--gross-m", "0.005"}).out);
  EXPECT_EQ(strict["gross_failures"], 1);
}

TEST(Command, EvalFailsWhenNothingMeets) {
  const test::TemporaryFolder folder;
  const std::string trajectory = folder.file("t", "10 5 5 0\n10.5 6 5 0\n").string();
  const Outcome none = run({"eval", "relations", folder.file("r", "1 2 1 0 0 0 0 0\n").string(), trajectory});
  EXPECT_EQ(none.status, 65);
  EXPECT_THAT(none.err, HasSubstr("--tolerance-s"));
  EXPECT_EQ(run({"eval", "ate", folder.file("o", "1 1 1 1\n2 1 1 1\n").string(), trajectory}).status, 65);
}

}  // namespace
}  // namespace odoless
