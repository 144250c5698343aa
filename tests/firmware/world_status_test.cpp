// What a daemon says of its world, for a person and for a program.
#include "firmware/health/world_status.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace odoless {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const GraphHealth kGraph{
    .submaps = 12, .keyframes = 240, .used = 0.25, .is_localising = true, .place = WorldPlaceKnown::kGuessed};

TEST(WorldStatus, SaysWhichWorldItIsAndHowFull) {
  const WorldStatus status{kGraph, WorldReport{.file = "/a/w", .uuid = "8a1c", .revision = 17, .age_s = 0.3}};
  EXPECT_THAT(world_status_text(status),
              AllOf(HasSubstr("world: /a/w, 8a1c, revision 17\n"), HasSubstr("mode: continue: the map grows"),
                    HasSubstr("place of the robot: guessed\n"),
                    HasSubstr("map: 12 submaps, 240 keyframes, 25 % of its room\n"), HasSubstr("written 0.3 s ago\n")));
  const auto json = world_status_json(status);
  EXPECT_EQ(json["file"], "/a/w");
  EXPECT_EQ(json["mode"], "continue");
  EXPECT_EQ(json["place"], "guessed");
  EXPECT_EQ(json["room_used"], 0.25);
  EXPECT_EQ(json["going_over"], false);
}

TEST(WorldStatus, TellsOfTheFileWhereThereIsOneElseOfTheGraph) {
  const WorldStatus in_memory{kGraph, std::nullopt};
  EXPECT_EQ(in_memory.use(), WorldUse::kLocalise);
  EXPECT_THAT(world_status_text(in_memory),
              AllOf(HasSubstr("in memory alone"), HasSubstr("mode: localise"), Not(HasSubstr("written"))));
  const WorldStatus to_be_closed{kGraph, WorldReport{.file = "/a/w", .is_going_over = true, .uuid = "8a1c"}};
  EXPECT_EQ(to_be_closed.use(), WorldUse::kContinue) << "it is written yet";
  EXPECT_TRUE(to_be_closed.is_going_over());
  EXPECT_THAT(world_status_text(to_be_closed), HasSubstr("going over to the other"));
}

TEST(WorldStatus, SaysWhyTheFileIsNotWritten) {
  WorldReport file{.file = "/a/w", .is_read_only = true, .uuid = "8a1c", .refused = "it was replaced"};
  EXPECT_THAT(world_status_text({kGraph, file}),
              AllOf(HasSubstr("closed: all is written"), HasSubstr("mapping does not go on: it was replaced")));
  file = {.file = "/a/w", .uuid = "8a1c", .age_s = 4.0, .error = 28, .reason = "No space left on device"};
  EXPECT_THAT(world_status_text({kGraph, file}), HasSubstr("cannot be written for 4 s: No space left on device"));
  EXPECT_EQ(world_status_json({kGraph, file})["error"], "No space left on device");
}

}  // namespace
}  // namespace odoless
