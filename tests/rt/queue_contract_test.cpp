// What every queue promises, over every queue; and each against a std::deque with its overflow policy.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <numeric>
#include <optional>
#include <vector>

#include "rt/evicting_queue.hpp"
#include "rt/record_ring.hpp"
#include "rt/rejecting_queue.hpp"
#include "tests/support/allocation_guard.hpp"

namespace odoless {
namespace {

using Value = std::uint64_t;

enum class Overflow { kRefuseNewest, kEvictOldest };

/// The queues behind one face. `push` returns what was lost by it.
struct Rejecting {
  static constexpr Overflow kOverflow = Overflow::kRefuseNewest;
  explicit Rejecting(std::size_t capacity) : queue(capacity) {}
  std::optional<Value> push(Value value) { return queue.try_push(value) ? std::nullopt : std::optional(value); }
  std::optional<Value> pop() {
    Value value = 0;
    return queue.try_pop(value) ? std::optional(value) : std::nullopt;
  }
  [[nodiscard]] std::uint64_t lost() const { return queue.rejected(); }
  [[nodiscard]] std::size_t high_water() const { return queue.high_water(); }
  RejectingQueue<Value> queue;
};

struct Evicting {
  static constexpr Overflow kOverflow = Overflow::kEvictOldest;
  explicit Evicting(std::size_t capacity) : queue(capacity) {}
  std::optional<Value> push(Value value) { return queue.push(value); }
  std::optional<Value> pop() { return queue.try_pop(); }
  [[nodiscard]] std::uint64_t lost() const { return queue.evicted(); }
  [[nodiscard]] std::size_t high_water() const { return queue.high_water(); }
  EvictingQueue<Value> queue;
};

/// Records of one value, of which a ring of 16 bytes for each holds exactly its capacity.
struct Records {
  static constexpr Overflow kOverflow = Overflow::kRefuseNewest;
  static constexpr std::size_t kRecord_bytes = 16;
  explicit Records(std::size_t capacity) : ring(capacity * kRecord_bytes) {}
  std::optional<Value> push(Value value) {
    const std::span<std::byte> room = ring.reserve(7, sizeof(value));
    if (room.empty()) {
      return value;
    }
    std::memcpy(room.data(), &value, sizeof(value));
    ring.commit();
    return std::nullopt;
  }
  std::optional<Value> pop() {
    const auto record = ring.front();
    if (!record) {
      return std::nullopt;
    }
    Value value = 0;
    std::memcpy(&value, record->bytes.data(), sizeof(value));
    ring.pop();
    return value;
  }
  [[nodiscard]] std::uint64_t lost() const { return ring.rejected(); }
  [[nodiscard]] std::size_t high_water() const { return ring.high_water_bytes() / kRecord_bytes; }
  RecordRing ring;
};

template <class Queue>
class QueueContract : public ::testing::Test {};

using Queues = ::testing::Types<Rejecting, Evicting, Records>;
TYPED_TEST_SUITE(QueueContract, Queues);

TYPED_TEST(QueueContract, IsEmptyAtFirst) {
  TypeParam queue(4);
  EXPECT_EQ(queue.pop(), std::nullopt);
  EXPECT_EQ(queue.lost(), 0U);
  EXPECT_EQ(queue.high_water(), 0U);
}

TYPED_TEST(QueueContract, HoldsItsWholeCapacityInOrder) {
  for (const std::size_t capacity : {2U, 3U, 8U, 100U}) {
    TypeParam queue(capacity);
    for (Value value = 0; value < capacity; ++value) {
      ASSERT_EQ(queue.push(value), std::nullopt);
    }
    EXPECT_EQ(queue.high_water(), capacity);
    for (Value value = 0; value < capacity; ++value) {
      ASSERT_EQ(queue.pop(), value);
    }
    EXPECT_EQ(queue.pop(), std::nullopt);
  }
}

TYPED_TEST(QueueContract, LosesOneByItsPolicyWhenFull) {
  TypeParam queue(2);
  EXPECT_EQ(queue.push(10), std::nullopt);
  EXPECT_EQ(queue.push(11), std::nullopt);
  const bool evicts = TypeParam::kOverflow == Overflow::kEvictOldest;
  EXPECT_EQ(queue.push(12), evicts ? 10 : 12);
  EXPECT_EQ(queue.lost(), 1U);
  EXPECT_EQ(queue.pop(), evicts ? 11 : 10);
}

TYPED_TEST(QueueContract, DoesAsADequeOfItsPolicyDoes) {
  const bool right = rc::check("as a deque", [] {
    const auto capacity = *rc::gen::inRange<std::size_t>(2, 9);
    TypeParam queue(capacity);
    std::deque<Value> model;
    std::size_t high_water = 0;
    std::uint64_t lost = 0;
    for (const bool is_push :
         *rc::gen::container<std::vector<bool>>(200, rc::gen::weightedElement<bool>({{3, true}, {2, false}}))) {
      static Value next = 0;
      if (!is_push) {
        const auto expected = model.empty() ? std::nullopt : std::optional(model.front());
        RC_ASSERT(queue.pop() == expected);
        model.erase(model.begin(), model.begin() + (model.empty() ? 0 : 1));
        continue;
      }
      model.push_back(++next);
      std::optional<Value> expected;
      if (model.size() > capacity) {
        const bool evicts = TypeParam::kOverflow == Overflow::kEvictOldest;
        expected = evicts ? model.front() : model.back();
        evicts ? model.pop_front() : model.pop_back();
        ++lost;
      }
      high_water = std::max(high_water, model.size());
      RC_ASSERT(queue.push(next) == expected);
      RC_ASSERT(queue.high_water() == high_water);
      RC_ASSERT(queue.lost() == lost);
    }
  });
  EXPECT_TRUE(right);
}

TYPED_TEST(QueueContract, LeavesTheHeapAloneAfterConstruction) {
  TypeParam queue(4);
  const AllocationGuard heap;
  for (Value value = 0; value < 100; ++value) {
    queue.push(value);
    queue.push(value);
    queue.pop();
  }
  EXPECT_EQ(heap.calls(), 0);
}

TEST(EvictingQueue, OfNoCapacityHoldsOne) {
  EvictingQueue<std::uint32_t> queue(0);
  EXPECT_EQ(queue.capacity(), 1U);
  EXPECT_EQ(queue.push(1), std::nullopt);
  EXPECT_EQ(queue.push(2), 1U);
  EXPECT_EQ(queue.try_pop(), 2U);
  EXPECT_EQ(queue.try_pop(), std::nullopt);
}

TEST(RejectingQueue, SaysItsSizeAndCapacity) {
  RejectingQueue<int> queue(3);
  EXPECT_EQ(queue.capacity(), 3U);
  EXPECT_TRUE(queue.try_push(1));
  EXPECT_TRUE(queue.try_push(2));
  EXPECT_EQ(queue.size(), 2U);
}

}  // namespace
}  // namespace odoless
