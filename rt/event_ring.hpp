#pragma once

#include <fmt/core.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <variant>

#include "rt/rejecting_queue.hpp"

namespace odoless {

/// Priorities of the system's journal (syslog.h).
enum class EventPriority : std::uint8_t {
  kEmergency = 0,
  kAlert = 1,
  kCritical = 2,
  kError = 3,
  kWarning = 4,
  kNotice = 5,
  kInfo = 6,
  kDebug = 7,
};

/// A number as an event carries it.
using EventArgument = std::variant<std::int64_t, double>;

/// A line for the log, not yet formatted.
struct Event {
  static constexpr std::size_t kMaxArguments = 4;

  std::int64_t stamp_ns = 0;
  EventPriority priority = EventPriority::kInfo;
  std::uint8_t argument_count = 0;
  const char* format = "";  ///< lives as long as the program
  std::array<EventArgument, kMaxArguments> arguments{};
};

/// As which of the two kinds of EventArgument a number travels.
template <class Number>
using EventNumber = std::conditional_t<std::is_floating_point_v<Number>, double, std::int64_t>;

/// Log lines from a real-time thread, to be formatted and written by another.
///
/// Thread:    one producer (`push`), one consumer (`try_pop`): one ring per thread that logs.
/// Real time: `push` copies the numbers, wait-free; formatting is for the consumer. Lines without room are lost and
///            counted.
class EventRing {
 public:
  explicit EventRing(std::size_t capacity) : queue_(capacity) {}

  /// @param format   A string literal of fmt's language, checked against the numbers while compiling.
  /// @param numbers  At most four, whole (as std::int64_t) or real (as double).
  /// @return         False if the ring is full.
  template <class... Numbers>
  bool push(std::int64_t stamp_ns, EventPriority priority, fmt::format_string<EventNumber<Numbers>...> format,
            Numbers... numbers) {
    static_assert(sizeof...(Numbers) <= Event::kMaxArguments);
    static_assert((std::is_arithmetic_v<Numbers> && ...));
    Event event{.stamp_ns = stamp_ns,
                .priority = priority,
                .argument_count = static_cast<std::uint8_t>(sizeof...(Numbers)),
                .format = fmt::string_view(format).data()};
    [[maybe_unused]] std::size_t next = 0;
    ((event.arguments[next++] = static_cast<EventNumber<Numbers>>(numbers)), ...);
    return queue_.try_push(event);
  }

  /// False if there is none: `event` is as it was.
  [[nodiscard]] bool try_pop(Event& event) { return queue_.try_pop(event); }

  [[nodiscard]] std::size_t capacity() const { return queue_.capacity(); }

  /// Lines that were lost since construction; from any thread.
  [[nodiscard]] std::uint64_t rejected() const { return queue_.rejected(); }

  /// The most lines that were waiting; from any thread.
  [[nodiscard]] std::size_t high_water() const { return queue_.high_water(); }

 private:
  RejectingQueue<Event> queue_;
};

/// The line of an event, without stamp and priority. Not for real-time threads: allocates.
[[nodiscard]] std::string format(const Event& event);

}  // namespace odoless
