#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/check.hpp"
#include "core/base/result.hpp"

namespace odoless {

/// Between two numbers.
struct OnTheLine {
  double operator()(double before, double after, double share) const { return before + share * (after - before); }
};

/// The last values of something that is measured now and then, for its value at any moment between.
///
/// `Between{}(a, b, share)` is the value on the way from a (share 0) to b (share 1).
///
/// Thread:    one thread.
/// Real time: no allocation after construction; `at` takes at most log2(capacity) steps.
template <class Value, class Between>
class StampedHistory {
 public:
  /// @param gap_max_ns  Between values farther apart than this nothing is known.
  StampedHistory(std::size_t capacity, std::int64_t gap_max_ns) : gap_max_ns_(gap_max_ns), samples_(capacity) {
    ODOLESS_CHECK(capacity > 0);
  }

  /// Adds a value; false, and nothing added, where the stamp is not later than the last one's. The oldest goes when
  /// there is no room.
  bool add(std::int64_t stamp_ns, const Value& value) {
    if (count_ > 0 && stamp_ns <= sample(count_ - 1).stamp_ns) {
      return false;
    }
    samples_[(first_ + count_) % samples_.size()] = {stamp_ns, value};
    if (count_ < samples_.size()) {
      ++count_;
    } else {
      first_ = (first_ + 1) % samples_.size();
    }
    return true;
  }

  void clear() { count_ = 0; }

  /// The value at that moment, between its two neighbours.
  ///
  /// Errc::kNotYet: nothing later is there, perhaps it will come; kTooOld: the values of that time are gone, or never
  /// were; kGap: the two neighbours are too far apart.
  [[nodiscard]] Result<Value> at(std::int64_t stamp_ns) const {
    if (count_ == 0 || stamp_ns > sample(count_ - 1).stamp_ns) {
      return Errc::kNotYet;
    }
    if (stamp_ns < sample(0).stamp_ns) {
      return Errc::kTooOld;
    }
    const std::size_t before = last_not_later(stamp_ns);
    const Sample& left = sample(before);
    if (stamp_ns == left.stamp_ns) {
      return left.value;
    }
    const Sample& right = sample(before + 1);
    if (stamp_ns == right.stamp_ns) {
      return right.value;
    }
    const std::int64_t gap_ns = right.stamp_ns - left.stamp_ns;
    if (gap_ns > gap_max_ns_) {
      return Errc::kGap;
    }
    return Between{}(left.value, right.value,
                     static_cast<double>(stamp_ns - left.stamp_ns) / static_cast<double>(gap_ns));
  }

  struct Sample {
    std::int64_t stamp_ns = 0;
    Value value{};
  };

  [[nodiscard]] std::size_t size() const { return count_; }
  /// The i-th since the oldest.
  [[nodiscard]] const Sample& sample(std::size_t i) const { return samples_[(first_ + i) % samples_.size()]; }

  /// Of two samples or more, the last but the newest whose stamp is not later, or the oldest; of one, that one.
  [[nodiscard]] std::size_t last_not_later(std::int64_t stamp_ns) const {
    std::size_t before = 0;
    std::size_t after = count_ - 1;
    while (after - before > 1) {
      const std::size_t middle = before + (after - before) / 2;
      (sample(middle).stamp_ns <= stamp_ns ? before : after) = middle;
    }
    return before;
  }

 private:
  std::int64_t gap_max_ns_;
  std::vector<Sample> samples_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace odoless
