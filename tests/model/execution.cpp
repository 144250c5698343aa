#include "tests/model/execution.hpp"

#include <algorithm>

namespace odoless::model {

void join(Clock& clock, const Clock& other) {
  for (std::size_t i = 0; i < clock.size(); ++i) {
    clock[i] = std::max(clock[i], other[i]);
  }
}

std::uint8_t Execution::add_place(std::uint64_t value) {
  const auto place = static_cast<std::uint8_t>(order_.size());
  order_.push_back({EventId{kInitial, place}});
  first_values_.push_back(value);
  return place;
}

std::uint64_t Execution::value_of(EventId write) const {
  return write.thread == kInitial ? first_values_[write.index] : at(write).value;
}

const Clock& Execution::before(std::size_t thread, std::size_t index) const {
  return index == 0 ? start_[thread] : events_[thread][index - 1].before;
}

void Execution::begin_after_all(std::size_t thread) {
  for (std::size_t other = 0; other < kThreads; ++other) {
    start_[thread][other] = static_cast<std::uint8_t>(other == thread ? 0 : events_[other].size());
  }
}

std::size_t Execution::position_of(std::uint8_t place, EventId write) const {
  return static_cast<std::size_t>(std::ranges::find(order_[place], write) - order_[place].begin());
}

/// The first write that may still be read after `before`: none that is overwritten there, none older than one read
/// there.
std::size_t Execution::floor(const Clock& before, std::uint8_t place) const {
  std::size_t first = 0;
  for (std::uint8_t thread = 0; thread < kThreads; ++thread) {
    for (std::uint8_t index = before[thread]; index-- > 0;) {
      const Event& event = events_[thread][index];
      if (event.place == place) {
        first = std::max(first, position_of(place, event.is_write ? EventId{thread, index} : event.from));
        break;  // what its thread did here before is older
      }
    }
  }
  return first;
}

Event Execution::next_event(std::size_t thread, std::uint8_t place) const {
  const std::size_t index = events_[thread].size();
  Event event;
  event.place = place;
  event.before = before(thread, index);
  event.causes = index == 0 ? start_[thread] : events_[thread][index - 1].causes;
  event.before[thread] = event.causes[thread] = static_cast<std::uint8_t>(index + 1);
  return event;
}

std::vector<EventId> Execution::readable(std::size_t thread, std::uint8_t place) const {
  const auto first = static_cast<std::ptrdiff_t>(floor(before(thread, events_[thread].size()), place));
  return {order_[place].begin() + first, order_[place].end()};
}

/// Lets a read that is new in its thread read `from`.
void Execution::take_over(std::size_t thread, Event& read, EventId from) const {
  const Reading& reading = read.reading;
  const Event fresh = next_event(thread, read.place);
  read.from = from;
  read.value = value_of(from);
  read.before = fresh.before;
  read.causes = fresh.causes;
  if (from.thread == kInitial) {
    return;
  }
  join(read.causes, at(from).causes);
  const bool failed = reading.compares && read.value != reading.expected;
  if (failed ? reading.acquires_failed : reading.acquires) {
    join(read.before, at(from).message);
  }
}

void Execution::add_read(std::size_t thread, std::uint8_t place, EventId from, const Reading& reading) {
  Event event;
  event.place = place;
  event.reading = reading;
  event.number = next_number_++;
  take_over(thread, event, from);
  events_[thread].push_back(event);
}

std::vector<std::size_t> Execution::positions(std::size_t thread, std::uint8_t place, bool is_exchange) const {
  const std::vector<EventId>& order = order_[place];
  std::vector<std::size_t> possible;
  const auto add = [&](std::size_t position) {
    if (position == order.size() || !this->is_exchange(order[position])) {
      possible.push_back(position);
    }
  };
  if (is_exchange) {
    add(position_of(place, events_[thread].back().from) + 1);
    return possible;
  }
  for (std::size_t position = floor(before(thread, events_[thread].size()), place) + 1; position <= order.size();
       ++position) {
    add(position);
  }
  return possible;
}

void Execution::add_write(std::size_t thread, std::uint8_t place, std::size_t position, const Writing& writing) {
  Event event = next_event(thread, place);
  event.is_write = true;
  event.is_exchange = writing.is_exchange;
  event.value = writing.value;
  event.number = next_number_++;
  if (writing.releases) {
    event.message = event.before;
  }
  if (writing.is_exchange) {  // it passes on what the write before it released
    const EventId from = events_[thread].back().from;
    join(event.message, from.thread == kInitial ? Clock{} : at(from).message);
  }
  const EventId id{static_cast<std::uint8_t>(thread), static_cast<std::uint8_t>(events_[thread].size())};
  events_[thread].push_back(event);
  order_[place].insert(order_[place].begin() + static_cast<std::ptrdiff_t>(position), id);
}

/// Whether, of what came before it and what the revisiting write depends on, the event is the newest of its place, and
/// a write is read by none of them. An execution is revisited from the only one in which all that is deleted is so.
bool Execution::is_maximal(EventId event, const Clock& causes) const {
  const std::uint32_t number = at(event).number;
  const auto is_previous = [&](EventId id) {
    return id.thread == kInitial || at(id).number <= number || includes(causes, id);
  };
  const std::uint8_t place = at(event).place;
  if (at(event).is_write) {
    for (std::uint8_t thread = 0; thread < kThreads; ++thread) {
      for (std::uint8_t index = 0; index < events_[thread].size(); ++index) {
        const Event& read = events_[thread][index];
        if (!read.is_write && read.place == place && read.from == event && is_previous({thread, index})) {
          return false;
        }
      }
    }
  }
  const EventId write = at(event).is_write ? event : at(event).from;
  const auto after = order_[place].begin() + static_cast<std::ptrdiff_t>(position_of(place, write)) + 1;
  return is_previous(write) && std::none_of(after, order_[place].end(), is_previous);
}

bool Execution::may_revisit(EventId read, const Clock& causes) const {
  if (!is_maximal(read, causes)) {
    return false;
  }
  for (std::uint8_t thread = 0; thread < kThreads; ++thread) {
    for (std::uint8_t index = causes[thread]; index < events_[thread].size(); ++index) {
      if (at({thread, index}).number > at(read).number && !is_maximal({thread, index}, causes)) {
        return false;
      }
    }
  }
  return true;
}

/// What was there when the read was added, and what `causes` includes.
Execution Execution::without_what_follows(EventId read, const Clock& causes) const {
  Execution kept = *this;
  for (std::uint8_t thread = 0; thread < kThreads; ++thread) {
    std::size_t size = events_[thread].size();
    while (size > causes[thread] && events_[thread][size - 1].number > at(read).number) {
      --size;
    }
    kept.events_[thread].resize(size);
  }
  for (auto& order : kept.order_) {
    std::erase_if(order,
                  [&](EventId id) { return id.thread != kInitial && id.index >= kept.events_[id.thread].size(); });
  }
  return kept;
}

std::vector<Execution> Execution::revisits(std::size_t thread, std::uint8_t place, const Writing& writing) const {
  std::vector<Execution> found;
  const Clock causes = next_event(thread, place).causes;
  const EventId write{static_cast<std::uint8_t>(thread), static_cast<std::uint8_t>(events_[thread].size())};
  for (std::uint8_t reader = 0; reader < kThreads; ++reader) {
    for (std::uint8_t index = causes[reader]; index < events_[reader].size(); ++index) {
      const EventId read{reader, index};
      if (at(read).is_write || at(read).place != place || !may_revisit(read, causes)) {
        continue;
      }
      const Execution kept = without_what_follows(read, causes);
      for (const std::size_t position : kept.positions(thread, place, writing.is_exchange)) {
        Execution revisited = kept;
        revisited.add_write(thread, place, position, writing);
        Event again = revisited.at(read);
        revisited.events_[reader].pop_back();
        if (position >= revisited.floor(revisited.before(reader, index), place)) {
          revisited.take_over(reader, again, write);
          revisited.events_[reader].push_back(again);
          found.push_back(std::move(revisited));
        }
      }
    }
  }
  return found;
}

}  // namespace odoless::model
