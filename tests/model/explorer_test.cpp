// The explorer itself: it runs each execution that the memory model allows once, and no other.
#include "tests/model/explorer.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/model/atomic.hpp"
#include "tests/model/oracle.hpp"

namespace odoless::model {
namespace {

/// Runs the threads of an `Outline`, whose memory is atomic.
class Outlined final : public Scenario {
 public:
  explicit Outlined(const Outline& outline) : outline_(outline) {}
  void run(std::size_t thread) override {
    for (const Operation& operation : outline_[thread]) {
      Atomic<int>& place = places_.at(operation.place);
      switch (operation.kind) {
        case Operation::Kind::kLoad:
          place.load(operation.order);
          break;
        case Operation::Kind::kStore:
          place.store(1, operation.order);
          break;
        case Operation::Kind::kExchange:
          place.fetch_add(1, operation.order);
          break;
      }
    }
  }

 private:
  const Outline& outline_;
  std::array<Atomic<int>, kPlaces> places_;
};

const Outline* outline_under_test = nullptr;

std::uint64_t executions_of(const Outline& outline) {
  outline_under_test = &outline;
  const Verdict verdict = Explorer().explore({"", outline.size(), []() -> std::unique_ptr<Scenario> {
                                                return std::make_unique<Outlined>(*outline_under_test);
                                              }});
  EXPECT_EQ(verdict.problem, "");
  return verdict.executions;
}

constexpr auto kRelaxed = std::memory_order_relaxed;
constexpr auto kAcquire = std::memory_order_acquire;
constexpr auto kRelease = std::memory_order_release;
constexpr auto kLoad = Operation::Kind::kLoad;
constexpr auto kStore = Operation::Kind::kStore;
constexpr auto kExchange = Operation::Kind::kExchange;

TEST(Explorer, RunsEachExecutionOfTheUsualLitmusTestsOnce) {
  const auto store = [](std::size_t place) { return Operation{kStore, place, kRelease}; };
  const auto load = [](std::size_t place) { return Operation{kLoad, place, kAcquire}; };
  EXPECT_EQ(executions_of({{store(0), load(1)}, {store(1), load(0)}}), 4);  // store buffering: both may see nothing
  EXPECT_EQ(executions_of({{store(0), store(1)}, {load(1), load(0)}}), 3);  // message passing
  EXPECT_EQ(executions_of({{{kStore, 0, kRelaxed}, {kStore, 1, kRelaxed}}, {load(1), load(0)}}), 4);
  EXPECT_EQ(executions_of({{load(0), store(1)}, {load(1), store(0)}}), 3);  // load buffering: not both
  EXPECT_EQ(executions_of({{store(0), store(1)}, {store(1), store(0)}}),
            4);  // 2 + 2 writes, in any order of each place
  EXPECT_EQ(executions_of({{store(0)}, {store(1)}, {load(0), load(1)}, {load(1), load(0)}}), 16);
  EXPECT_EQ(executions_of({{store(0)}, {load(0), load(0)}}), 3);  // never newer before older
  const Operation add{kExchange, 0, kRelaxed};
  EXPECT_EQ(executions_of({{add, add, add}, {add, add, add}}), 20);
}

rc::Gen<Outline> outlines() {
  const auto operation = rc::gen::construct<Operation>(rc::gen::element(kLoad, kStore, kExchange),
                                                       rc::gen::inRange<std::size_t>(0, kPlaces),
                                                       rc::gen::element(kRelaxed, std::memory_order_acq_rel));
  const auto thread = [&](std::size_t size) { return rc::gen::container<std::vector<Operation>>(size, operation); };
  return rc::gen::map(rc::gen::tuple(thread(2), thread(2), thread(1)), [](const auto& threads) {
    return Outline{std::get<0>(threads), std::get<1>(threads), std::get<2>(threads)};
  });
}

RC_GTEST_PROP(Explorer, RunsAsManyExecutionsAsThereAreByTheAxioms, ()) {
  const Outline outline = *outlines();
  RC_ASSERT(executions_of(outline) == count_by_axioms(outline));
}

/// Writes plain memory, hands it on, and a third thread passes that on in a way of its own before it is read.
class ReleaseSequence final : public Scenario {
 public:
  explicit ReleaseSequence(bool by_exchange) : by_exchange_(by_exchange) {}
  void run(std::size_t thread) override {
    if (thread == 0) {
      plain_ = 7;
      flag_.store(1, kRelease);
    } else if (thread == 1 && by_exchange_) {
      flag_.fetch_add(1, kRelaxed);
    } else if (thread == 1 && flag_.load(kRelaxed) == 1) {
      flag_.store(2, kRelaxed);
    } else if (thread == 2 && flag_.load(kAcquire) == 2) {
      require(plain_.get() == 7, "what was released is not seen");
    }
  }

 private:
  bool by_exchange_;
  Plain<int> plain_;
  Atomic<int> flag_ = 0;
};

TEST(Explorer, AnExchangePassesOnWhatWasReleasedAndAStoreDoesNot) {
  EXPECT_EQ(Explorer()
                .explore({"", 3, []() -> std::unique_ptr<Scenario> { return std::make_unique<ReleaseSequence>(true); }})
                .problem,
            "");
  EXPECT_NE(
      Explorer()
          .explore({"", 3, []() -> std::unique_ptr<Scenario> { return std::make_unique<ReleaseSequence>(false); }})
          .problem,
      "");
}

/// Three want the one thing that is there.
class CompareAndSwap final : public Scenario {
 public:
  void run(std::size_t thread) override {
    int expected = 0;
    won_.at(thread) = taken_.compare_exchange_strong(expected, static_cast<int>(thread) + 1, kRelaxed, kRelaxed);
    require(won_.at(thread) == (expected == 0), "a swap fails on what it expects");
  }
  void look_at_the_end() override { require(won_[0] + won_[1] + won_[2] == 1, "not one has it"); }

 private:
  std::array<int, 3> won_{};
  Atomic<int> taken_ = 0;
};

TEST(Explorer, OneOfThreeSwapsSucceeds) {
  const Verdict verdict =
      Explorer().explore({"", 3, []() -> std::unique_ptr<Scenario> { return std::make_unique<CompareAndSwap>(); }});
  EXPECT_EQ(verdict.problem, "");
  EXPECT_EQ(verdict.executions, 3);
}

}  // namespace
}  // namespace odoless::model
