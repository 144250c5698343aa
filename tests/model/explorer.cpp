#include "tests/model/explorer.hpp"

#include <cstdio>
#include <cstdlib>
#include <utility>

namespace odoless::model {
namespace {

Explorer* current_explorer = nullptr;

bool is_acquire(std::memory_order order) {
  return order != std::memory_order_relaxed && order != std::memory_order_release;
}

bool is_release(std::memory_order order) {
  return order == std::memory_order_release || order == std::memory_order_acq_rel || order == std::memory_order_seq_cst;
}

}  // namespace

Explorer& Explorer::current() { return *current_explorer; }

Verdict Explorer::explore(const Program& program) {
  current_explorer = this;
  Verdict verdict;
  problem_.clear();
  pending_.assign(1, Execution());
  while (!pending_.empty() && problem_.empty()) {
    execution_ = std::move(pending_.back());
    pending_.pop_back();
    is_left_ = false;
    run_once(program);
    verdict.executions += is_left_ && problem_.empty() ? 0 : 1;
  }
  verdict.problem = problem_;
  return verdict;
}

void Explorer::run_once(const Program& program) {
  next_place_ = 0;
  done_ = {};
  memory_.clear();
  afterwards_.clear();
  scenario_ = program.make();
  for (std::size_t thread = 0; thread < program.threads; ++thread) {
    fibers_[thread].start([this, thread] { scenario_->run(thread); });
  }
  replay();
  for (thread_ = 0; thread_ < program.threads && !is_left_; ++thread_) {
    while (!fibers_[thread_].has_ended() && !is_left_) {
      fibers_[thread_].resume();
    }
  }
  if (!is_left_) {
    execution_.begin_after_all(thread_);
    fibers_[thread_].start([this] { scenario_->look_at_the_end(); });
    fibers_[thread_].resume();
  }
  thread_ = kThreads;
  scenario_.reset();
}

/// Brings every thread to where the execution leaves it.
void Explorer::replay() {
  is_replaying_ = true;
  for (bool goes_on = true; goes_on && !is_left_;) {
    goes_on = false;
    for (thread_ = 0; thread_ < kThreads && !is_left_; ++thread_) {
      const std::size_t size = execution_.events(thread_).size();
      if (!fibers_[thread_].has_ended()) {
        fibers_[thread_].resume();
      }
      goes_on |= done_[thread_] < size;
    }
  }
  is_replaying_ = false;
}

std::uint8_t Explorer::make_place(std::uint64_t value) {
  if (next_place_ == execution_.places()) {
    execution_.add_place(value);
  }
  return next_place_++;
}

/// Whether the operation is to be weaker so; notes that it could be.
bool Explorer::has(Weakening weakening, Site site) {
  site.function = site.function.substr(0, site.function.find('<'));  // of a template, all instances
  const Mutant mutant{site, weakening};
  if (!mutant_ && thread_ < kThreads) {
    mutants_.insert(mutant);
  }
  return mutant_ == mutant;
}

bool Explorer::acquires(std::memory_order order, Site site, Weakening without) {
  note_total_order(order, site);
  return is_acquire(order) && !has(without, site);
}

bool Explorer::releases(std::memory_order order, Site site) {
  note_total_order(order, site);
  return is_release(order) && !has(Weakening::kNoRelease, site);
}

/// The total order of sequential consistency is not explored: all has to hold without it.
void Explorer::note_total_order(std::memory_order order, Site site) {
  if (order == std::memory_order_seq_cst) {
    static_cast<void>(has(Weakening::kNoTotalOrder, site));
  }
}

/// The next event of the thread, if it is in the execution already.
const Event* Explorer::replayed(std::uint8_t place, bool is_write) {
  const std::size_t thread = thread_;
  const std::vector<Event>& events = execution_.events(thread);
  while (is_replaying_ && done_[thread] == events.size()) {
    fibers_[thread].yield();
  }
  if (done_[thread] == events.size()) {
    if (events.size() == kMaxEvents) {
      fail("a thread does not end");
    }
    return nullptr;
  }
  const Event& event = events[done_[thread]];
  if (event.place != place || event.is_write != is_write) {
    fail("the scenario does not do the same again");
  }
  while (!is_write && event.from.thread != kInitial && done_[event.from.thread] <= event.from.index) {
    fibers_[thread].yield();
  }
  ++done_[thread];
  return &event;
}

std::uint64_t Explorer::read(std::uint8_t place, const Reading& reading) {
  if (thread_ == kThreads) {
    const auto found = afterwards_.find(place);
    return found != afterwards_.end() ? found->second : execution_.value_of(execution_.order(place).back());
  }
  if (const Event* const event = replayed(place, false); event != nullptr) {
    return event->value;
  }
  const std::vector<EventId> writes = execution_.readable(thread_, place);
  for (std::size_t i = 0; i + 1 < writes.size(); ++i) {
    pending_.push_back(execution_);
    pending_.back().add_read(thread_, place, writes[i], reading);
  }
  execution_.add_read(thread_, place, writes.back(), reading);
  ++done_[thread_];
  return execution_.value_of(writes.back());
}

void Explorer::write(std::uint8_t place, const Writing& writing) {
  if (thread_ == kThreads) {
    afterwards_[place] = writing.value;
    return;
  }
  if (replayed(place, true) != nullptr) {
    return;
  }
  for (Execution& revisited : execution_.revisits(thread_, place, writing)) {
    pending_.push_back(std::move(revisited));
  }
  const std::vector<std::size_t> positions = execution_.positions(thread_, place, writing.is_exchange);
  if (positions.empty()) {  // two exchanges of one value: this one has to read the other's
    leave();
  }
  for (std::size_t i = 0; i + 1 < positions.size(); ++i) {
    pending_.push_back(execution_);
    pending_.back().add_write(thread_, place, positions[i], writing);
  }
  execution_.add_write(thread_, place, positions.back(), writing);
  ++done_[thread_];
}

std::uint64_t Explorer::load(std::uint8_t place, std::memory_order order, Site site) {
  return read(place, {.acquires = acquires(order, site, Weakening::kNoAcquire)});
}

void Explorer::store(std::uint8_t place, std::uint64_t value, std::memory_order order, Site site) {
  write(place, {.value = value, .releases = releases(order, site)});
}

std::uint64_t Explorer::exchange(std::uint8_t place, const Change& change, std::memory_order order, Site site) {
  const std::uint64_t was = read(place, {.acquires = acquires(order, site, Weakening::kNoAcquire)});
  write(place,
        {.value = change(was), .releases = releases(order, site), .is_exchange = !has(Weakening::kLoadAndStore, site)});
  return was;
}

std::uint64_t Explorer::compare_exchange(std::uint8_t place, std::uint64_t expected, std::uint64_t value, Orders orders,
                                         Site site) {
  const std::uint64_t was =
      read(place, {.acquires = acquires(orders.success, site, Weakening::kNoAcquire),
                   .compares = true,
                   .acquires_failed = acquires(orders.failure, site, Weakening::kNoAcquireWhereItFails),
                   .expected = expected});
  if (was == expected) {
    write(place, {.value = value,
                  .releases = releases(orders.success, site),
                  .is_exchange = !has(Weakening::kLoadAndStore, site)});
  }
  return was;
}

void Explorer::touch(const void* begin, std::size_t size_bytes, bool writes) {
  if (thread_ == kThreads) {
    return;  // before and after all
  }
  if (!memory_.touch(begin, size_bytes, writes, thread_, execution_.before(thread_, done_[thread_]))) {
    fail(writes ? "a data race: what is written here is still used there"
                : "a data race: what is read here is still written there");
  }
}

void Explorer::fail(const std::string& problem) {
  problem_ = problem + trace();
  leave();
}

void Explorer::leave() {
  is_left_ = true;
  fibers_[thread_].yield();
  std::abort();  // never gone on with
}

std::string Explorer::trace() const {
  std::string text;
  for (std::size_t thread = 0; thread < kThreads; ++thread) {
    for (const Event& event : execution_.events(thread)) {
      std::array<char, 80> line{};
      std::snprintf(line.data(), line.size(), "\n  thread %zu %s place %d: %llu", thread,
                    event.is_write ? (event.is_exchange ? "exchanges" : "writes") : "reads", event.place,
                    static_cast<unsigned long long>(event.value));
      text += line.data();
    }
  }
  return text;
}

}  // namespace odoless::model
