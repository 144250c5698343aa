#pragma once

#include "rt/evicting_queue.hpp"
#include "rt/latest_value.hpp"
#include "rt/record_ring.hpp"

/// The memory orders of the product, each weakened by one step: what the stress run has to find.
namespace odoless::stress {

struct UnpublishedToken : EvictingQueueOrders {
  static constexpr std::memory_order kPublishTail = std::memory_order_relaxed;
};
struct UnseenToken : EvictingQueueOrders {
  static constexpr std::memory_order kSeeTail = std::memory_order_relaxed;
};

struct UnpublishedValue : LatestValueOrders {
  static constexpr std::memory_order kPublish = std::memory_order_acquire;
};
struct UnawaitedReader : LatestValueOrders {
  static constexpr std::memory_order kPublish = std::memory_order_release;
};
struct UnseenValue : LatestValueOrders {
  static constexpr std::memory_order kUpdate = std::memory_order_release;
};
struct UnreleasedBuffer : LatestValueOrders {
  static constexpr std::memory_order kUpdate = std::memory_order_acquire;
};

struct UnpublishedRecord : RecordRingOrders {
  static constexpr std::memory_order kPublishTail = std::memory_order_relaxed;
};
struct UnseenRecord : RecordRingOrders {
  static constexpr std::memory_order kSeeTail = std::memory_order_relaxed;
};
struct UnreleasedRoom : RecordRingOrders {
  static constexpr std::memory_order kPublishHead = std::memory_order_relaxed;
};
struct UnseenRoom : RecordRingOrders {
  static constexpr std::memory_order kSeeHead = std::memory_order_relaxed;
};

}  // namespace odoless::stress
