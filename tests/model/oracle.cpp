#include "tests/model/oracle.hpp"

#include <algorithm>
#include <array>

namespace odoless::model {
namespace {

/// A read or a write; an exchange is one of each. The first are the values that the places are made with.
struct Half {
  std::size_t place;
  bool writes;
  bool is_exchange;
  bool is_ordered;  ///< acquires or releases
};

class Relation {
 public:
  explicit Relation(std::size_t size) : size_(size), holds_(size * size, false) {}
  [[nodiscard]] bool operator()(std::size_t a, std::size_t b) const { return holds_[a * size_ + b]; }
  void add(std::size_t a, std::size_t b) { holds_[a * size_ + b] = true; }
  void close() {  // Warshall
    for (std::size_t via = 0; via < size_; ++via) {
      for (std::size_t a = 0; a < size_; ++a) {
        for (std::size_t b = 0; b < size_ && (*this)(a, via); ++b) {
          if ((*this)(via, b)) {
            add(a, b);
          }
        }
      }
    }
  }
  [[nodiscard]] bool has_circle() const {
    for (std::size_t a = 0; a < size_; ++a) {
      if ((*this)(a, a)) {
        return true;
      }
    }
    return false;
  }

 private:
  std::size_t size_;
  std::vector<bool> holds_;
};

bool is_acquire(const Operation& operation) {
  return operation.order == std::memory_order_acquire || operation.order == std::memory_order_acq_rel;
}
bool is_release(const Operation& operation) {
  return operation.order == std::memory_order_release || operation.order == std::memory_order_acq_rel;
}

class Count {
 public:
  explicit Count(const Outline& outline) : in_program_(0) {
    for (std::size_t place = 0; place < kPlaces; ++place) {
      halves_.push_back({place, true, false, false});
    }
    std::vector<std::size_t> firsts;
    for (const auto& thread : outline) {
      firsts.push_back(halves_.size());
      for (const Operation& operation : thread) {
        const bool is_exchange = operation.kind == Operation::Kind::kExchange;
        if (operation.kind != Operation::Kind::kStore) {
          halves_.push_back({operation.place, false, is_exchange, is_acquire(operation)});
        }
        if (operation.kind != Operation::Kind::kLoad) {
          halves_.push_back({operation.place, true, is_exchange, is_release(operation)});
        }
      }
    }
    firsts.push_back(halves_.size());
    in_program_ = Relation(halves_.size());
    for (std::size_t thread = 0; thread + 1 < firsts.size(); ++thread) {
      for (std::size_t b = firsts[thread]; b < firsts[thread + 1]; ++b) {
        for (std::size_t a = 0; a < b; ++a) {
          if (a < kPlaces || a >= firsts[thread]) {
            in_program_.add(a, b);
          }
        }
      }
    }
    from_.resize(halves_.size());
    for (std::size_t half = 0; half < halves_.size(); ++half) {
      if (halves_[half].writes) {
        orders_.at(halves_[half].place).push_back(half);
      }
    }
  }

  std::uint64_t count() {
    choose_from(0);
    return count_;
  }

 private:
  void choose_from(std::size_t read) {
    if (read == halves_.size()) {
      if (!has_causal_circle()) {
        choose_order(0);
      }
    } else if (halves_[read].writes) {
      choose_from(read + 1);
    } else {
      for (const std::size_t write : std::vector(orders_.at(halves_[read].place))) {
        from_[read] = write;
        choose_from(read + 1);
      }
    }
  }

  void choose_order(std::size_t place) {
    if (place == kPlaces) {
      count_ += is_consistent() ? 1 : 0;
      return;
    }
    auto& order = orders_.at(place);
    std::sort(order.begin() + 1, order.end());  // the first is the one it is made with
    do {
      choose_order(place + 1);
    } while (std::next_permutation(order.begin() + 1, order.end()));
  }

  /// The write that heads the releases which `write` passes on, from itself back over exchanges.
  void synchronize(Relation& before, std::size_t read) const {
    for (std::size_t write = from_[read]; halves_[read].is_ordered; write = from_[write - 1]) {
      if (halves_[write].is_ordered) {
        before.add(write, read);
      }
      if (!halves_[write].is_exchange) {
        return;
      }
    }
  }

  [[nodiscard]] bool has_causal_circle() const {
    Relation causes = in_program_;
    for (std::size_t read = 0; read < halves_.size(); ++read) {
      if (!halves_[read].writes) {
        causes.add(from_[read], read);
      }
    }
    causes.close();
    return causes.has_circle();
  }

  [[nodiscard]] bool is_consistent() const {
    if (!is_atomic()) {
      return false;
    }
    Relation before = in_program_;
    for (std::size_t read = 0; read < halves_.size(); ++read) {
      if (!halves_[read].writes) {
        synchronize(before, read);
      }
    }
    before.close();
    return is_coherent(before);
  }

  /// What happens before something neither overwrites it nor what it reads, and reads nothing newer.
  [[nodiscard]] bool is_coherent(const Relation& before) const {
    Relation later(halves_.size());
    for (const auto& order : orders_) {
      for (std::size_t i = 0; i < order.size(); ++i) {
        for (std::size_t j = i + 1; j < order.size(); ++j) {
          later.add(order[i], order[j]);
        }
      }
    }
    for (std::size_t read = 0; read < halves_.size(); ++read) {
      if (!halves_[read].writes) {
        later.add(from_[read], read);
        const auto& order = orders_.at(halves_[read].place);
        for (auto newer = std::find(order.begin(), order.end(), from_[read]) + 1; newer != order.end(); ++newer) {
          later.add(read, *newer);
        }
      }
    }
    later.close();
    for (std::size_t a = 0; a < halves_.size(); ++a) {
      for (std::size_t b = 0; b < halves_.size(); ++b) {
        if (later(a, b) && (before(b, a) || a == b)) {
          return false;
        }
      }
    }
    return true;
  }

  [[nodiscard]] bool is_atomic() const {
    for (std::size_t write = kPlaces; write < halves_.size(); ++write) {
      if (halves_[write].writes && halves_[write].is_exchange) {
        const auto& order = orders_.at(halves_[write].place);
        const auto here = std::find(order.begin(), order.end(), write);
        if (*(here - 1) != from_[write - 1]) {
          return false;
        }
      }
    }
    return true;
  }

  std::vector<Half> halves_;
  Relation in_program_;
  std::vector<std::size_t> from_;  ///< of each read, the write
  std::array<std::vector<std::size_t>, kPlaces> orders_;
  std::uint64_t count_ = 0;
};

}  // namespace

std::uint64_t count_by_axioms(const Outline& outline) { return Count(outline).count(); }

}  // namespace odoless::model
