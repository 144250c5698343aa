// First, as it changes what the headers of the product are made of; they are otherwise as they are.
#include "tests/model/substituted.hpp"

// Then the product's.
#include "firmware/sources/line_handover.hpp"
#include "rt/evicting_queue.hpp"
#include "rt/latest_value.hpp"
#include "rt/record_ring.hpp"
#include "rt/rejecting_queue.hpp"
#include "tests/model/scenarios.hpp"

namespace odoless::model {
namespace {

constexpr std::size_t kProducer = 0;

using Number = Plain<std::uint64_t>;

/// Values that came out, each of 1, 2, ... once and on each way in order.
class Arrivals {
 public:
  void add(std::uint64_t number, std::uint64_t& last) {
    require(number > last, "a value comes late or twice");
    last = number;
    require((seen_ & 1U << number) == 0, "a value comes out on both sides");
    seen_ |= 1U << number;
  }
  void require_all(std::uint64_t count) const { require(seen_ == (2U << count) - 2U, "a value is lost"); }

 private:
  unsigned seen_ = 0;  ///< only ever used by one thread of the system
};

/// Tokens whose meaning is written before they are pushed.
template <std::size_t capacity, std::uint64_t pushes, int pops>
class Evicting final : public Scenario {
 public:
  void run(std::size_t thread) override { thread == kProducer ? produce() : consume(); }

  void look_at_the_end() override {
    std::size_t left = 0;
    for (; const auto token = queue_.try_pop(); ++left) {
      receive(*token);
    }
    require(left <= capacity, "more are left than there is room for");
    arrivals_.require_all(pushes);
    require(queue_.evicted() == evicted_, "an eviction is not counted");
  }

 private:
  void produce() {
    for (std::uint64_t number = 1; number <= pushes; ++number) {
      meaning_[number] = number;
      if (const auto oldest = queue_.push(static_cast<std::uint32_t>(number))) {
        arrivals_.add(*oldest, last_evicted_);
        ++evicted_;
      }
    }
  }
  void consume() {
    for (int i = 0; i < pops; ++i) {
      if (const auto token = queue_.try_pop()) {
        receive(*token);
      }
    }
  }
  void receive(std::uint32_t token) {
    require(token >= 1 && token <= pushes, "a token that was never pushed");
    require(meaning_[token].get() == token, "a token comes before what it stands for");
    arrivals_.add(token, last_);
  }

  EvictingQueue<std::uint32_t> queue_{capacity};
  std::array<Number, pushes + 1> meaning_;
  Arrivals arrivals_;
  std::uint64_t last_evicted_ = 0;
  std::uint64_t evicted_ = 0;
  std::uint64_t last_ = 0;
};

/// Slots of a pool, to the consumer through an evicting queue and back through a rejecting one, as scans go.
template <std::uint64_t pushes, int pops>
class Pool final : public Scenario {
 public:
  Pool() { free_.reserve(kSlots); }
  void run(std::size_t thread) override { thread == kProducer ? produce() : consume(); }

 private:
  static constexpr std::uint32_t kSlots = 3;

  void produce() {
    for (std::uint64_t number = 1; number <= pushes; ++number) {
      for (std::uint32_t slot = 0; returned_.try_pop(slot);) {
        give(slot);
      }
      require(!free_.empty(), "there is no free slot");
      const std::uint32_t slot = free_.back();
      free_.pop_back();
      scans_[slot] = number;
      if (const auto oldest = filled_.push(slot)) {
        give(*oldest);
      }
    }
  }
  void give(std::uint32_t slot) {
    require(std::ranges::find(free_, slot) == free_.end(), "a slot comes back twice");
    free_.push_back(slot);
  }
  void consume() {
    std::uint64_t last = 0;
    for (int i = 0; i < pops; ++i) {
      if (const auto slot = filled_.try_pop()) {
        const std::uint64_t number = scans_[*slot].get();
        require(number > last, "a scan comes late or twice");
        last = number;
        require(returned_.try_push(*slot), "more slots than there are");
      }
    }
  }

  EvictingQueue<std::uint32_t> filled_{kSlots - 2};
  RejectingQueue<std::uint32_t> returned_{kSlots};
  std::array<Number, kSlots> scans_;
  std::vector<std::uint32_t> free_{0, 1, 2};
};

template <std::uint64_t pushes, int pops>
class Rejecting final : public Scenario {
 public:
  void run(std::size_t thread) override { thread == kProducer ? produce() : consume(pops); }

  void look_at_the_end() override {
    consume(kCapacity + 1);
    require(received_ == accepted_, "a value is lost");
    require(queue_.rejected() == pushes - accepted_, "a refusal is not counted");
  }

 private:
  static constexpr int kCapacity = 1;

  void produce() {
    for (std::uint64_t i = 0; i < pushes; ++i) {
      accepted_ += queue_.try_push(Number(accepted_ + 1)) ? 1 : 0;
    }
  }
  void consume(int tries) {
    for (Number number; tries > 0; --tries) {
      if (queue_.try_pop(number)) {
        require(number.get() == ++received_, "a value is lost, doubled or late");
      }
    }
  }

  RejectingQueue<Number> queue_{kCapacity};
  std::uint64_t accepted_ = 0;
  std::uint64_t received_ = 0;
};

template <std::uint64_t writes, int updates>
class Latest final : public Scenario {
 public:
  void run(std::size_t thread) override {
    if (thread == kProducer) {
      for (std::uint64_t number = 1; number <= writes; ++number) {
        latest_.write(number);
      }
    } else {
      for (int i = 0; i < updates; ++i) {
        update();
      }
    }
  }

  void look_at_the_end() override {
    update();
    require(last_ == writes, "the last value is not seen");
  }

 private:
  void update() {
    const bool is_newer = latest_.update();
    const std::uint64_t number = latest_.value().get();
    require(is_newer ? number > last_ : number == last_, "a value is not the newer one");
    last_ = number;
  }

  LatestValue<Number> latest_{0};
  std::uint64_t last_ = 0;
};

/// A ring of 4 words: records of one word or two, with their headers; one that does not fit before the end.
template <int tries, int looks>
class Records final : public Scenario {
 public:
  void run(std::size_t thread) override { thread == kProducer ? produce() : consume(looks); }

  void look_at_the_end() override {
    consume(tries);
    require(received_ == sent_, "a record is lost");
    require(ring_.rejected() == tries - sent_, "a refusal is not counted");
    require(ring_.reserve(0, ring_.max_record_bytes()).data() != nullptr, "an empty ring has no room");
  }

 private:
  static constexpr std::size_t kMemory_bytes = 32;
  static std::size_t size_bytes(std::uint32_t number) { return number % 3 == 0 ? 0 : 8; }

  void produce() {
    for (int i = 0; i < tries; ++i) {
      const auto room = ring_.reserve(sent_, size_bytes(sent_));
      if (room.data() != nullptr) {
        const std::uint64_t filling = sent_;
        copy_plain(room.data(), &filling, room.size());
        ring_.commit();
        ++sent_;
      }
    }
  }
  void consume(int tries_left) {
    for (; tries_left > 0; --tries_left) {
      if (const auto record = ring_.front()) {
        require(record->type == received_ && record->bytes.size() == size_bytes(received_), "a record is lost or late");
        std::uint64_t filling = received_;
        copy_plain(&filling, record->bytes.data(), record->bytes.size());
        require(filling == received_, "a record is half old and half new");
        ring_.pop();
        ++received_;
      }
    }
  }

  RecordRing ring_{kMemory_bytes};
  std::uint32_t sent_ = 0;
  std::uint32_t received_ = 0;
};

/// The supervisor opens (writes) and closes (writes) a line that the sensor thread uses.
template <int offers, int uses>
class Line final : public Scenario {
 public:
  void run(std::size_t thread) override { thread == kProducer ? supervise() : sense(); }

  void look_at_the_end() override {
    close(handover_.clear());
    require(opened_ - closed_ <= 1, "a line is lost");
  }

 private:
  void supervise() {
    for (int i = 0; i < 2 * offers; ++i) {
      if (const int returned = handover_.take_back(); returned >= 0) {
        close(returned);
      } else if (handover_.is_empty()) {
        require(closed_ == opened_, "a line is opened beside one that is in use");
        line_ = static_cast<std::uint64_t>(++opened_);
        handover_.offer(opened_);
      }
    }
    close(handover_.clear());
  }
  void close(int descriptor) {
    if (descriptor >= 0) {
      require(line_.get() == static_cast<std::uint64_t>(descriptor), "another line is given back");
      line_ = 0;
      ++closed_;
    }
  }
  void sense() {
    for (int i = 0; i < uses; ++i) {
      if (const int descriptor = handover_.take(); descriptor >= 0) {
        require(line_.get() == static_cast<std::uint64_t>(descriptor), "the line is not open");
        handover_.give_back(descriptor);
      }
    }
  }

  LineHandover handover_;
  Number line_;
  int opened_ = 0;
  int closed_ = 0;
};

template <class S>
constexpr Program program(const char* name) {
  return {name, 2, []() -> std::unique_ptr<Scenario> { return std::make_unique<S>(); }};
}

constexpr std::array kPrograms{
    program<Evicting<1, 4, 4>>("evicting_queue of 1"),
    program<Evicting<2, 5, 3>>("evicting_queue of 2"),
    program<Pool<4, 3>>("pool"),
    program<Rejecting<5, 5>>("rejecting_queue"),
    program<Latest<5, 5>>("latest_value"),
    program<Records<6, 5>>("record_ring"),
    program<Line<3, 4>>("line_handover"),
};

}  // namespace

std::span<const Program> programs() { return kPrograms; }

}  // namespace odoless::model
