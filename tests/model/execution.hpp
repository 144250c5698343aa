#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

/// One execution of a few threads under the C++ memory model: which write each read reads from, and in which order the
/// writes to each place stand.
namespace odoless::model {

inline constexpr std::size_t kThreads = 5;  ///< at most, with the one that looks at the end

/// Of each thread, how many of its events come before.
using Clock = std::array<std::uint8_t, kThreads>;

void join(Clock& clock, const Clock& other);

struct EventId {
  std::uint8_t thread;  ///< kInitial: the value that place `index` is made with, which comes before all else
  std::uint8_t index;   ///< in its thread
  friend bool operator==(const EventId&, const EventId&) = default;
};
inline constexpr std::uint8_t kInitial = 0xFF;

[[nodiscard]] inline bool includes(const Clock& clock, EventId id) {
  return id.thread == kInitial || clock[id.thread] > id.index;
}

/// A read, as what it is done: a compare-and-swap is another one where it fails.
struct Reading {
  bool acquires = false;
  bool compares = false;         ///< a compare-and-swap
  bool acquires_failed = false;  ///< where the value is not `expected`
  std::uint64_t expected = 0;
};

struct Event {
  bool is_write = false;
  bool is_exchange = false;  ///< the write of a read-modify-write: nothing stands between it and what that read
  std::uint8_t place = 0;
  std::uint32_t number = 0;  ///< counts the events of an exploration as they are added
  std::uint64_t value = 0;   ///< written or read
  Reading reading;
  EventId from{};   ///< of a read: the write whose value it has
  Clock before{};   ///< happens-before, this event included
  Clock causes{};   ///< the same of program order and reads-from, whatever the memory orders
  Clock message{};  ///< of a write: what who acquires it takes over
};

/// A write as its thread asks for it.
struct Writing {
  std::uint64_t value = 0;
  bool releases = false;
  bool is_exchange = false;
};

class Execution {
 public:
  /// A place in memory with its first value. All are made before the first event.
  std::uint8_t add_place(std::uint64_t value);

  /// The writes that a read by this thread may read now.
  [[nodiscard]] std::vector<EventId> readable(std::size_t thread, std::uint8_t place) const;
  void add_read(std::size_t thread, std::uint8_t place, EventId from, const Reading& reading);

  /// Where in the order of the place's writes one by this thread may stand. Of an exchange: behind what was just read.
  [[nodiscard]] std::vector<std::size_t> positions(std::size_t thread, std::uint8_t place, bool is_exchange) const;
  void add_write(std::size_t thread, std::uint8_t place, std::size_t position, const Writing& writing);

  /// The executions in which a read that is here already reads the write that this thread asks for instead, and what
  /// depends on that read is not yet there. Of the algorithm TruSt; each execution comes up once.
  [[nodiscard]] std::vector<Execution> revisits(std::size_t thread, std::uint8_t place, const Writing& writing) const;

  /// The thread begins after all events of all others.
  void begin_after_all(std::size_t thread);

  [[nodiscard]] const std::vector<Event>& events(std::size_t thread) const { return events_[thread]; }
  [[nodiscard]] std::uint64_t value_of(EventId write) const;
  /// What happens before a thread's event `index`, or before all of them.
  [[nodiscard]] const Clock& before(std::size_t thread, std::size_t index) const;
  /// The order of the writes to a place.
  [[nodiscard]] const std::vector<EventId>& order(std::uint8_t place) const { return order_[place]; }
  [[nodiscard]] std::size_t places() const { return order_.size(); }

 private:
  [[nodiscard]] const Event& at(EventId id) const { return events_[id.thread][id.index]; }
  [[nodiscard]] Event& at(EventId id) { return events_[id.thread][id.index]; }
  [[nodiscard]] std::size_t position_of(std::uint8_t place, EventId write) const;
  [[nodiscard]] std::size_t floor(const Clock& before, std::uint8_t place) const;
  [[nodiscard]] bool is_exchange(EventId write) const { return write.thread != kInitial && at(write).is_exchange; }
  void take_over(std::size_t thread, Event& read, EventId from) const;
  [[nodiscard]] Event next_event(std::size_t thread, std::uint8_t place) const;
  [[nodiscard]] bool may_revisit(EventId read, const Clock& causes) const;
  [[nodiscard]] bool is_maximal(EventId event, const Clock& causes) const;
  [[nodiscard]] Execution without_what_follows(EventId read, const Clock& causes) const;

  std::array<std::vector<Event>, kThreads> events_;
  std::array<Clock, kThreads> start_{};
  std::vector<std::vector<EventId>> order_;
  std::vector<std::uint64_t> first_values_;
  std::uint32_t next_number_ = 1;
};

}  // namespace odoless::model
