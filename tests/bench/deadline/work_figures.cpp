#include "tests/bench/deadline/work_figures.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdio>

#include "rt/cpu_clock.hpp"
#include "tests/bench/deadline/work_counter.hpp"

namespace odoless {
namespace {

double now() {
  return counts_blocks() ? 1e-3 * static_cast<double>(blocks_run()) : 1e-6 * static_cast<double>(thread_cpu_ns());
}

}  // namespace

void WorkClock::begin(double deadline) {
  begin_ = asked_ = now();
  end_ = begin_ + deadline;
}

Deadline WorkClock::deadline() {
  return {[](const void* self) {
            auto& clock = *static_cast<WorkClock*>(const_cast<void*>(self));
            return clock.ask() >= clock.end_;
          },
          this};
}

double WorkClock::ask() {
  const double asked = now();
  longest_ = std::max(longest_, asked - asked_);
  return asked_ = asked;
}

void Figures::print_head() {
  std::printf("%-8s %-18s %6s %9s %9s %6s %9s %9s %5s %10s\n", "stage", "scans", "number", "median", "worst", "ratio",
              "after", "unasked", "over", "plain");
}

double Figures::median() {
  std::sort(used_.begin(), used_.end());
  return used_.empty() ? 0.0 : used_[used_.size() / 2];
}

bool Figures::report(const char* stage, const char* kind, const Bounds& bounds, double unasked, double plain) {
  const double median = this->median();
  const double worst = used_.back();
  const double most = bounds.deadline + bounds.after_max;
  const auto over = used_.end() - std::upper_bound(used_.begin(), used_.end(), most);
  const bool kept = over == 0 && unasked <= bounds.unasked_max;
  std::printf("%-8s %-18s %6zu %9.2f %9.2f %6.2f %9.2f %9.2f %5td %10.2f %s\n", stage, kind, used_.size(), median,
              worst, worst / median, std::max(0.0, worst - bounds.deadline), unasked, over, plain,
              kept ? "" : "BROKEN");
  return kept;
}

}  // namespace odoless
