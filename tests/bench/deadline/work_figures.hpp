#pragma once

#include <vector>

#include "core/base/deadline.hpp"

namespace odoless {

inline constexpr double kUnlimited = 1e18;

/// Milliseconds of CPU time, or thousands of basic blocks.
struct Bounds {
  double deadline = kUnlimited;
  double after_max = kUnlimited;    ///< most after the deadline
  double unasked_max = kUnlimited;  ///< most between two questions to it
};

/// The clock of a piece of work, that a Deadline asks.
class WorkClock {
 public:
  void begin(double deadline);
  [[nodiscard]] double used() { return ask() - begin_; }
  /// Most work between two questions, of all that was begun.
  [[nodiscard]] double longest_step() const { return longest_; }
  [[nodiscard]] Deadline deadline();

 private:
  double ask();

  double begin_ = 0.0;
  double end_ = 0.0;
  double asked_ = 0.0;
  double longest_ = 0.0;
};

/// What pieces of work of one kind took: a row of the table.
class Figures {
 public:
  static void print_head();

  void add(double used) { used_.push_back(used); }
  /// 0 where there are none.
  [[nodiscard]] double median();
  /// Prints them beside what the same takes where nobody asks. Returns whether every bound was kept.
  [[nodiscard]] bool report(const char* stage, const char* kind, const Bounds& bounds, double unasked, double plain);

 private:
  std::vector<double> used_;
};

}  // namespace odoless
