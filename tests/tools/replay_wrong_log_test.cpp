// A log that is wrong gives no result that says it is good, and ends nothing: it is refused, corrected with a word, or
// its result is said to be doubtful.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <ostream>
#include <sstream>

#include "core/base/rng.hpp"
#include "tests/support/run_command.hpp"
#include "tests/support/stamp_faults.hpp"
#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

using test::Outcome;
using test::run;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kDegreeOfLogRad = std::numbers::pi / 180.0;

/// A scan as a test may change it.
struct Scan {
  double stamp_s = 0.0;
  double start_rad = -std::numbers::pi / 2.0;
  double step_rad = 0.0;
  std::vector<double> ranges_m;
};
using Scans = std::vector<Scan>;

Scans read_flaser(const std::filesystem::path& path) {
  Scans scans;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream fields(line);
    std::string kind;
    std::size_t size = 0;
    if (!(fields >> kind >> size) || kind != "FLASER") {
      continue;
    }
    Scan scan;
    scan.step_rad = std::numbers::pi / static_cast<double>(size - 1);
    scan.ranges_m.resize(size);
    std::for_each(scan.ranges_m.begin(), scan.ranges_m.end(), [&](double& range_m) { fields >> range_m; });
    double skipped = 0.0;
    for (int i = 0; i < 6; ++i) {
      fields >> skipped;
    }
    fields >> scan.stamp_s;
    scans.push_back(scan);
  }
  return scans;
}

std::string to_csv(const Scans& scans) {
  std::string text;
  for (const Scan& scan : scans) {
    text += fmt::format("{:.9f},{:.9f},{:.9f},0,0.2,0.05,80,{}", scan.stamp_s, scan.start_rad, scan.step_rad,
                        scan.ranges_m.size());
    for (const double range_m : scan.ranges_m) {
      text += fmt::format(",{:.5f}", range_m);
    }
    text += "\n";
  }
  return text;
}

struct Mistake {
  const char* name;
  std::function<void(Scans&)> make;
  bool is_corrected = false;  ///< the result is as good as without it, and stderr says what was corrected
};
std::ostream& operator<<(std::ostream& out, const Mistake& mistake) { return out << mistake.name; }

template <class Change>
std::function<void(Scans&)> of_each(Change change) {
  return [change](Scans& scans) { std::for_each(scans.begin(), scans.end(), change); };
}

void scale_ranges(Scan& scan, double factor) {
  for (double& range_m : scan.ranges_m) {
    range_m *= factor;
  }
}

void shuffle_stamps(Scans& scans) {
  Rng rng(1);
  for (std::size_t i = scans.size() - 1; i > 0; --i) {
    std::swap(scans[i].stamp_s, scans[rng.below(static_cast<std::uint32_t>(i + 1))].stamp_s);
  }
}

void shuffle_neighbours(Scans& scans) {
  Rng rng(2);
  for (std::size_t i = 0; i + 4 < scans.size(); i += 4) {
    std::swap(scans[i], scans[i + 1 + rng.below(3)]);
  }
}

std::vector<Mistake> mistakes() {
  return {
      {"StampsReversed",
       [](Scans& scans) {
         for (std::size_t i = 0; i < scans.size() / 2; ++i) {
           std::swap(scans[i].stamp_s, scans[scans.size() - 1 - i].stamp_s);
         }
       }},
      {"FileReversed", [](Scans& scans) { std::reverse(scans.begin(), scans.end()); }},
      {"StampsShuffled", shuffle_stamps},
      {"LinesShuffled", shuffle_neighbours, true},
      {"StampsDividedBy1000", of_each([](Scan& scan) { scan.stamp_s /= 1000.0; }), true},
      {"StampsInMilliseconds", of_each([](Scan& scan) { scan.stamp_s *= 1000.0; }), true},
      {"StampsOfTheEpochInMilliseconds", of_each([](Scan& scan) { scan.stamp_s = (scan.stamp_s + 1.6e9) * 1000.0; }),
       true},
      {"AnglesInDegrees", of_each([](Scan& scan) {
         scan.start_rad /= kDegreeOfLogRad;
         scan.step_rad /= kDegreeOfLogRad;
       }),
       true},
      {"StartAloneInDegrees", of_each([](Scan& scan) { scan.start_rad /= kDegreeOfLogRad; })},
      {"TwiceTheStep", of_each([](Scan& scan) { scan.step_rad *= 2.0; })},
      {"HalfTheStep", of_each([](Scan& scan) { scan.step_rad *= 0.5; })},
      {"RangesInMillimetres", of_each([](Scan& scan) { scale_ranges(scan, 1000.0); }), true},
      {"RangesInCentimetres", of_each([](Scan& scan) { scale_ranges(scan, 100.0); })},
      {"NothingSeen", of_each([](Scan& scan) { std::fill(scan.ranges_m.begin(), scan.ranges_m.end(), 81.0); })},
      {"NothingAtAll", of_each([](Scan& scan) { std::fill(scan.ranges_m.begin(), scan.ranges_m.end(), 0.0); })},
      {"ScansMissing",
       [](Scans& scans) {
         const auto middle = scans.begin() + static_cast<std::ptrdiff_t>(scans.size() / 2);
         scans.erase(middle - 20, middle + 20);
       }},
      {"ScansShuffledWithoutStamps",
       [](Scans& scans) {
         shuffle_stamps(scans);
         std::sort(scans.begin(), scans.end(), [](const Scan& a, const Scan& b) { return a.stamp_s < b.stamp_s; });
       }},
  };
}

/// A small room and a way of half a minute.
class WrongLog : public ::testing::TestWithParam<Mistake> {
 protected:
  void SetUp() override {
    const auto world = folder_.file("room.world",
                                    "room 0 0  8 6\nbox 2 2.5  1 0.5\nbox 4.5 4  0.5 1\npillar 6 2.5 0.2\n"
                                    "speed 0.5\nturn_rate 60\ngo 1 1  7 1  7 5  4 5\n");
    const Outcome made = run({"sim", world.string(), "--out", (folder_.path() / "room.log").string(), "--seed", "3"});
    ASSERT_EQ(made.status, 0) << made.err;
    scans_ = read_flaser(folder_.path() / "room.log");
    ASSERT_GT(scans_.size(), 80U);
  }

  [[nodiscard]] Outcome job(const char* command, const std::vector<std::string>& options = {}) {
    const auto log = folder_.file("log.csv", to_csv(scans_));
    std::vector<std::string> arguments{command, log.string(), "--force", "--out", (folder_.path() / command).string()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run(arguments);
  }
  [[nodiscard]] nlohmann::json summary() const {
    return nlohmann::json::parse(std::ifstream(folder_.path() / "replay" / "summary.json"));
  }

  test::TemporaryFolder folder_;
  Scans scans_;
};

TEST_P(WrongLog, GivesNoResultThatSaysItIsGood) {
  GetParam().make(scans_);
  const Outcome replayed = job("replay");
  if (GetParam().is_corrected) {
    EXPECT_EQ(replayed.status, 0) << replayed.err;
    EXPECT_THAT(replayed.out, HasSubstr("result: good"));
    EXPECT_THAT(replayed.err, HasSubstr("log.csv: ")) << "a word of what was corrected";
    EXPECT_EQ(summary()["corrected"].size(), 1U);
    return;
  }
  EXPECT_TRUE(replayed.status == 65 || replayed.status == 0) << replayed.status;
  EXPECT_THAT(replayed.out, Not(HasSubstr("result: good")));
  EXPECT_THAT(replayed.err, HasSubstr("log.csv: "));
  EXPECT_EQ(job("replay", {"--strict"}).status, 65);
}

TEST_P(WrongLog, EndsNoOtherJob) {
  GetParam().make(scans_);
  const Outcome matched = job("match");
  EXPECT_TRUE(matched.status == 0 || matched.status == 65) << matched.status << matched.err;
  const Outcome told = run({"info", (folder_.path() / "log.csv").string()});
  EXPECT_EQ(told.status, 0) << told.err;
  if (matched.status == 65) {
    EXPECT_THAT(told.out, HasSubstr("wrong     "));
  }
}

INSTANTIATE_TEST_SUITE_P(Mistakes, WrongLog, ::testing::ValuesIn(mistakes()),
                         [](const auto& tested) { return std::string(tested.param.name); });

class RightLog : public WrongLog {};

TEST_P(RightLog, IsGoodAlsoWhereStampsWaver) {
  GetParam().make(scans_);
  const Outcome replayed = job("replay", {"--strict"});
  EXPECT_EQ(replayed.status, 0) << replayed.err;
  EXPECT_THAT(replayed.out, HasSubstr("result: good"));
  EXPECT_EQ(replayed.err, "");
  const nlohmann::json told = summary();
  EXPECT_EQ(told["result"], "good");
  EXPECT_EQ(told["reasons"].size(), 0U);
  EXPECT_EQ(told["scans"], scans_.size());
}

INSTANTIATE_TEST_SUITE_P(Stamps, RightLog,
                         ::testing::Values(Mistake{"Even", [](Scans&) {}},
                                           Mistake{"Wavering",
                                                   [](Scans& scans) {
                                                     std::vector<std::int64_t> stamps_ns;
                                                     for (const Scan& scan : scans) {
                                                       stamps_ns.push_back(std::llround(scan.stamp_s * 1e9));
                                                     }
                                                     stamps_ns = test::waver(stamps_ns, 1);
                                                     for (std::size_t i = 0; i < scans.size(); ++i) {
                                                       scans[i].stamp_s = static_cast<double>(stamps_ns[i]) * 1e-9;
                                                     }
                                                   }}),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace odoless
