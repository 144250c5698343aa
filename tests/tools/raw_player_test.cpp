#include "tools/emulate/raw_player.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "tests/support/times.hpp"

namespace odoless {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using test::kMs;
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

RawPiece sent(std::int64_t time_ms, const char* bytes) { return {time_ms * 1000, true, bytes}; }
RawPiece heard(std::int64_t time_ms, const char* bytes) { return {time_ms * 1000, false, bytes}; }

TEST(RawPlayer, AnswersACommandAsLongAfterItAsWasRecorded) {
  RawPlayer player({sent(100, "VV\n"), heard(103, "one"), heard(110, "two"), sent(120, "MD\n"), heard(125, "scan")});
  EXPECT_EQ(player.next_event_ns(), kNever);
  player.receive("VV\n", 5000 * kMs);
  EXPECT_THAT(player.take_due(5002 * kMs), IsEmpty());
  EXPECT_EQ(player.next_event_ns(), 5003 * kMs);
  EXPECT_THAT(player.take_due(5003 * kMs), ElementsAre("one"));
  EXPECT_THAT(player.take_due(5010 * kMs), ElementsAre("two"));
  EXPECT_FALSE(player.is_over());
  player.receive("MD\n", 6000 * kMs);
  EXPECT_THAT(player.take_due(6005 * kMs), ElementsAre("scan"));
  EXPECT_TRUE(player.is_over());
  EXPECT_EQ(player.counts().answered, 2);
  EXPECT_EQ(player.counts().sent, 3);
}

TEST(RawPlayer, TakesCommandsInPiecesTogetherAndInAnotherOrder) {
  RawPlayer player({sent(0, "A1\n"), heard(1, "a"), sent(2, "B\n"), heard(3, "b"), sent(4, "A1\n"), heard(5, "c")});
  player.receive("B", 0);
  EXPECT_THAT(player.take_due(100 * kMs), IsEmpty());
  player.receive("\nA1", 200 * kMs);
  EXPECT_THAT(player.take_due(300 * kMs), ElementsAre("b"));
  player.receive("\nA1\n", 400 * kMs);
  EXPECT_THAT(player.take_due(500 * kMs), ElementsAre("a", "c"));
  EXPECT_TRUE(player.is_over());
}

TEST(RawPlayer, PassesOverWhatWasNeverRecordedAndRepeatsWhatIsUsedUp) {
  RawPlayer player({heard(0, "rest"), sent(10, "QT\n"), heard(11, "00P")});
  player.receive("what?QT\n", 0);
  EXPECT_EQ(player.counts().unknown, 5);
  EXPECT_THAT(player.take_due(kMs), ElementsAre("rest", "00P"));
  EXPECT_TRUE(player.is_over());
  player.receive("QT\n", 2 * kMs);
  EXPECT_EQ(player.next_event_ns(), 3 * kMs);
  EXPECT_THAT(player.take_due(3 * kMs), ElementsAre("00P"));
  EXPECT_EQ(player.counts().unknown, 5);
  EXPECT_EQ(player.counts().repeated, 1);
}

TEST(RawPlayer, AStreamGoesOnForAClientThatStartsAnew) {
  RawPlayer player({sent(0, "MD\n"), heard(1, "ok"), heard(100, "one"), heard(200, "two")});
  player.receive("MD\n", 0);
  EXPECT_THAT(player.take_due(100 * kMs), ElementsAre("ok", "one"));
  player.receive("MD\n", 110 * kMs);
  EXPECT_THAT(player.take_due(150 * kMs), ElementsAre("ok"));
  EXPECT_THAT(player.take_due(200 * kMs), ElementsAre("two"));
}

TEST(RawPlayer, PassesOverWholeFramesThatAreNotKnown) {
  RawPlayer player({sent(0, "00AB"), heard(1, "yes")}, 4);
  player.receive("xx00", 0);  // its end is how the known one begins
  player.receive("00AB", 0);
  EXPECT_EQ(player.counts().unknown, 4);
  EXPECT_THAT(player.take_due(kMs), ElementsAre("yes"));
}

TEST(RawPlayer, NeverSendsAPieceBeforeAnEarlierOne) {
  RawPlayer player({sent(0, "A"), heard(50, "first"), sent(51, "B"), heard(52, "second")});
  player.receive("A", 0);
  player.receive("B", kMs);  // sooner than it was recorded: its answer is due before that of A
  EXPECT_THAT(player.take_due(10 * kMs), IsEmpty());
  EXPECT_THAT(player.take_due(50 * kMs), ElementsAre("first", "second"));
}

TEST(RawPlayer, SaysWhenWhatIsOnAnotherLineIsDue) {
  RawPlayer player({heard(0, "rest"), sent(10, "VV\n"), heard(20, "ok"), sent(100, "MD\n"), heard(110, "scan")});
  EXPECT_EQ(player.due_ns(5'000), kNever) << "nobody has spoken to it";
  player.receive("V", 1000 * kMs);
  EXPECT_EQ(player.due_ns(5'000), 1005 * kMs);
  EXPECT_EQ(player.due_ns(50'000), kNever);
  player.receive("V\n", 2000 * kMs);
  EXPECT_EQ(player.due_ns(50'000), 2040 * kMs);
  EXPECT_EQ(player.due_ns(110'000), kNever) << "it is not known when the next command comes";
  player.receive("MD\n", 9000 * kMs);
  EXPECT_EQ(player.due_ns(110'000), 9010 * kMs) << "with the scan";
  player.receive("MD\n", 9500 * kMs);
  EXPECT_EQ(player.due_ns(110'000), 9010 * kMs) << "a command that is repeated moves nothing";
}

TEST(RawPlayer, ACommandThatWasLeftOutAtFirstTakesTheOtherLinesBackToNothing) {
  RawPlayer player({sent(0, "A"), sent(10, "B"), heard(11, "b"), sent(100, "C"), heard(110, "scan")});
  player.receive("A", 0);
  player.receive("C", 1000 * kMs);
  EXPECT_EQ(player.due_ns(200'000), 1100 * kMs);
  player.receive("B", 2000 * kMs);
  EXPECT_EQ(player.due_ns(200'000), 1100 * kMs);
}

}  // namespace
}  // namespace odoless
