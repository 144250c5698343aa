#include "rt/record_ring.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <vector>

namespace odoless {
namespace {

struct Expected {
  std::uint32_t type;
  std::vector<std::byte> bytes;
};

std::size_t length_bytes(std::size_t size_bytes) { return 8 + (size_bytes + 7) / 8 * 8; }

class RingAndModel {
 public:
  explicit RingAndModel(std::size_t capacity_bytes) : ring_(capacity_bytes) {}

  void push(std::size_t size_bytes, std::size_t commit_bytes) {
    const auto type = static_cast<std::uint32_t>(next_);
    const std::uint64_t rejected_before = ring_.rejected();
    const std::span<std::byte> room = ring_.reserve(type, size_bytes);
    const bool has_room = room.data() != nullptr;
    RC_ASSERT(ring_.rejected() - rejected_before == (has_room ? 0U : 1U));
    RC_ASSERT((!has_room || used_bytes() + length_bytes(size_bytes) <= ring_.memory_bytes()));
    RC_ASSERT((has_room == (size_bytes <= ring_.max_record_bytes()) || !model_.empty()));
    if (!has_room) {
      return;
    }
    RC_ASSERT(room.size() == size_bytes);
    RC_ASSERT(reinterpret_cast<std::uintptr_t>(room.data()) % 8 == 0);
    std::generate(room.begin(), room.end(), [this] { return static_cast<std::byte>(next_++); });
    model_.push_back({type, {room.begin(), room.begin() + static_cast<std::ptrdiff_t>(commit_bytes)}});
    ring_.commit(commit_bytes);
    RC_ASSERT(ring_.high_water_bytes() >= used_bytes());
    RC_ASSERT(ring_.high_water_bytes() <= ring_.memory_bytes());
  }

  void pop() {
    const auto record = ring_.front();
    RC_ASSERT(record.has_value() == !model_.empty());
    if (record) {
      RC_ASSERT(record->type == model_.front().type);
      RC_ASSERT(std::ranges::equal(record->bytes, model_.front().bytes));
      ring_.pop();
      model_.pop_front();
    }
  }

 private:
  [[nodiscard]] std::size_t used_bytes() const {
    std::size_t sum_bytes = 0;
    for (const Expected& record : model_) {
      sum_bytes += length_bytes(record.bytes.size());
    }
    return sum_bytes;
  }

  RecordRing ring_;
  std::deque<Expected> model_;
  std::uint64_t next_ = 0;
};

RC_GTEST_PROP(RecordRing, RecordsOfAnySizeComeOutAsTheyWentIn, ()) {
  const auto capacity_bytes = *rc::gen::inRange<std::size_t>(0, 600);
  RingAndModel both(capacity_bytes);
  for (int step = 0; step < 300; ++step) {
    if (*rc::gen::inRange(0, 5) < 3) {
      const auto size_bytes = *rc::gen::inRange<std::size_t>(0, capacity_bytes / 2 + 40);
      both.push(size_bytes, *rc::gen::inRange(0, 3) == 0 ? size_bytes / 2 : size_bytes);
    } else {
      both.pop();
    }
  }
}

TEST(RecordRing, ShowsNothingBeforeTheCommit) {
  RecordRing ring(256);
  ASSERT_EQ(ring.reserve(1, 10).size(), 10U);
  EXPECT_FALSE(ring.front().has_value());
  ring.commit();
  EXPECT_TRUE(ring.front().has_value());
}

TEST(RecordRing, ForgetsAReservationThatAnotherFollows) {
  RecordRing ring(256);
  ASSERT_EQ(ring.reserve(1, 100).size(), 100U);
  ASSERT_EQ(ring.reserve(2, 3).size(), 3U);
  ring.commit();
  ASSERT_EQ(ring.front()->type, 2U);
  ASSERT_EQ(ring.front()->bytes.size(), 3U);
  ring.pop();
  EXPECT_FALSE(ring.front().has_value());
}

TEST(RecordRing, KeepsTheFrontUntilItIsPopped) {
  RecordRing ring(64);
  std::ranges::fill(ring.reserve(1, 24), std::byte{42});
  ring.commit();
  const auto front = ring.front();
  while (ring.reserve(2, 8).data() != nullptr) {
    ring.commit();
  }
  EXPECT_EQ(ring.rejected(), 1U);
  EXPECT_TRUE(std::ranges::all_of(front->bytes, [](std::byte byte) { return byte == std::byte{42}; }));
}

TEST(RecordRing, RefusesTheHugeWithoutOverflow) {
  RecordRing ring(256);
  for (const std::size_t size_bytes :
       {SIZE_MAX, SIZE_MAX - 7, SIZE_MAX - 15, std::size_t{0xFFFFFFFF}, ring.max_record_bytes() + 1}) {
    EXPECT_EQ(ring.reserve(1, size_bytes).data(), nullptr);
  }
  EXPECT_EQ(ring.rejected(), 5U);
}

TEST(RecordRing, TellsARecordOfNoBytesFromNoRoom) {
  RecordRing ring(32);
  ASSERT_NE(ring.reserve(9, 0).data(), nullptr);
  ring.commit();
  EXPECT_EQ(ring.front()->type, 9U);
  EXPECT_TRUE(ring.front()->bytes.empty());
}

TEST(RecordRing, RoundsItsMemoryUp) {
  EXPECT_EQ(RecordRing(0).memory_bytes(), 32U);
  EXPECT_EQ(RecordRing(33).memory_bytes(), 48U);
  EXPECT_EQ(RecordRing(64).memory_bytes(), 64U);
}

}  // namespace
}  // namespace odoless
