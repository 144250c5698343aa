#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "rt/evicting_queue.hpp"
#include "rt/latest_value.hpp"
#include "rt/record_ring.hpp"
#include "rt/rejecting_queue.hpp"
#include "tests/stress/scenario.hpp"

/// Two threads on each structure: order, no loss, no duplicate, no tearing. All payloads are plain memory, so that
/// ThreadSanitizer sees an order that is too weak even where the processor forgives it.
namespace odoless::stress {

using Payload = std::array<std::uint64_t, 4>;

inline Payload payload_of(std::uint64_t number) { return {number, ~number, number * 3, number ^ 0x5555}; }

/// The scan ring: tokens of slots go to the consumer, which gives them back; the newest win.
inline void pass_slots(std::uint64_t rounds) {
  constexpr std::uint32_t kSlots = 6;
  std::array<Payload, kSlots> slots{};
  EvictingQueue<std::uint32_t> filled(kSlots - 2);
  RejectingQueue<std::uint32_t> returned(kSlots);
  std::atomic<bool> done = false;
  std::uint64_t evicted = 0;
  std::uint64_t received = 0;

  const auto produce = [&] {
    Chance chance(1);
    std::vector<std::uint32_t> free{0, 1, 2, 3, 4, 5};
    std::uint64_t last_evicted = 0;
    for (std::uint64_t number = 1; number <= rounds; ++number) {
      for (std::uint32_t token = 0; returned.try_pop(token);) {
        free.push_back(token);
      }
      require(!free.empty() && free.size() <= kSlots, "a token is lost or doubled");
      const std::uint32_t slot = free.back();
      free.pop_back();
      slots[slot] = payload_of(number);
      if (const auto oldest = filled.push(slot)) {
        require(slots[*oldest][0] > last_evicted && slots[*oldest][0] < number, "evicted is not the oldest");
        last_evicted = slots[*oldest][0];
        free.push_back(*oldest);
        ++evicted;
      }
      chance.pause();
    }
    done = true;
  };
  const auto consume = [&] {
    Chance chance(2);
    std::uint64_t last = 0;
    for (bool ending = false;;) {
      const auto slot = filled.try_pop();
      if (!slot && ending) {
        return;
      }
      ending = !slot && done;
      if (slot) {
        const Payload seen = slots[*slot];
        require(seen == payload_of(seen[0]), "a scan is torn");
        require(seen[0] > last, "a scan comes late or twice");
        last = seen[0];
        ++received;
        require(returned.try_push(*slot), "more tokens than slots");
      }
      chance.pause();
    }
  };
  run_both(produce, consume);
  require(received + evicted == rounds && filled.evicted() == evicted, "a scan is neither seen nor counted");
}

inline void show_latest(std::uint64_t rounds) {
  LatestValue<Payload> latest(payload_of(0));
  run_both(
      [&] {
        Chance chance(3);
        for (std::uint64_t number = 1; number <= rounds; ++number) {
          latest.write(payload_of(number));
          chance.pause();
        }
      },
      [&] {
        Chance chance(4);
        std::uint64_t last = 0;
        while (last < rounds) {  // the last is always seen
          const bool newer = latest.update();
          const Payload seen = latest.value();
          require(seen == payload_of(seen[0]), "a value is torn");
          require(newer ? seen[0] > last : seen[0] == last, "a value is not the newer one");
          last = seen[0];
          chance.pause();
        }
      });
}

inline void pass_records(std::uint64_t rounds) {
  RecordRing ring(512);
  run_both(
      [&] {
        Chance chance(5);
        for (std::uint64_t number = 0; number < rounds; chance.pause()) {
          const std::size_t size_bytes = chance.below(200);
          const auto room = ring.reserve(static_cast<std::uint32_t>(number), size_bytes);
          if (room.data() != nullptr) {
            std::ranges::fill(room, static_cast<std::byte>(number + size_bytes));
            ring.commit();
            ++number;
          }
        }
      },
      [&] {
        Chance chance(6);
        for (std::uint64_t number = 0; number < rounds; chance.pause()) {
          if (const auto record = ring.front()) {
            require(record->type == static_cast<std::uint32_t>(number), "a record is lost, doubled or late");
            const auto filling = static_cast<std::byte>(number + record->bytes.size());
            require(std::ranges::all_of(record->bytes, [&](std::byte byte) { return byte == filling; }),
                    "a record is torn");
            ring.pop();
            ++number;
          }
        }
      });
}

inline void pass_values(std::uint64_t rounds) {
  RejectingQueue<Payload> queue(5);
  std::uint64_t refused = 0;
  run_both(
      [&] {
        Chance chance(7);
        for (std::uint64_t number = 0; number < rounds; chance.pause()) {
          queue.try_push(payload_of(number)) ? ++number : ++refused;
        }
      },
      [&] {
        Chance chance(8);
        Payload seen{};
        for (std::uint64_t number = 0; number < rounds; chance.pause()) {
          if (queue.try_pop(seen)) {
            require(seen == payload_of(number++), "a value is lost, doubled, late or torn");
          }
        }
      });
  require(queue.rejected() == refused, "a refusal is not counted");
}

/// Two threads on plain memory, which ThreadSanitizer has to see however the system runs them.
inline void race(std::uint64_t rounds) {
  volatile std::uint64_t shared = 0;
  const auto count = [&] {
    for (std::uint64_t i = 0; i < rounds; ++i) {
      shared = shared + 1;
    }
  };
  run_both(count, count);
}

}  // namespace odoless::stress
