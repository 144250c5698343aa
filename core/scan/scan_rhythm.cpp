#include "core/scan/scan_rhythm.hpp"

#include <algorithm>
#include <cmath>

namespace odoless {
namespace {

constexpr int kMemory = 400;            // scans over which squares are averaged
constexpr double kGain_min = 0.05;      // the period is known to a per cent or so, and may change
constexpr double kClip_periods = 10.0;  // a difference beyond says no more

}  // namespace

void ScanRhythm::add(double stamp_s) {
  stamps_s_[static_cast<std::size_t>(scans_ % kWindow)] = stamp_s;
  scans_ = scans_ + 1 < 2 * kWindow ? scans_ + 1 : scans_ + 1 - kWindow;
  total_ = std::min(total_ + 1, kMemory);
  if (scans_ >= 2) {
    period_s_ = std::max(kPeriod_min_s, median_slope_s());
    learn_differences();
    gain_ = learn_gain();
  }
}

void ScanRhythm::move_last(int scans, double by_s) {
  for (int back = 0; back < std::min(scans, held()); ++back) {
    stamps_s_[static_cast<std::size_t>((scans_ - 1 - back) % kWindow)] += by_s;
  }
}

double ScanRhythm::median_slope_s() const {
  const int span = held() / 2;
  const int slopes = held() - span;
  std::array<double, kWindow> slopes_s;
  for (int i = 0; i < slopes; ++i) {
    slopes_s[static_cast<std::size_t>(i)] = (at(i) - at(i + span)) / span;
  }
  auto* const middle = slopes_s.data() + slopes / 2;
  std::nth_element(slopes_s.data(), middle, slopes_s.data() + slopes);
  return slopes % 2 == 1 ? *middle : 0.5 * (*middle + *std::max_element(slopes_s.data(), middle));
}

void ScanRhythm::learn_differences() {
  const double clip_s = kClip_periods * period_s_;
  for (std::size_t i = 0; i < kSpans.size() && total_ > 2 * kSpans[i]; ++i) {
    const int span = kSpans[i];
    const double difference_s = std::clamp(at(0) - 2.0 * at(span) + at(2 * span), -clip_s, clip_s);
    squares_s2_[i] += (difference_s * difference_s - squares_s2_[i]) / std::min(total_ - 2 * span, kMemory);
  }
}

// By how much the variance of the time between two scans exceeds 0, from the growth of the squares up to a span.
double ScanRhythm::growth_s2(std::size_t longest) const {
  std::size_t largest = 0;
  for (std::size_t i = 1; i < longest; ++i) {
    largest = squares_s2_[i] > squares_s2_[largest] ? i : largest;
  }
  return std::max(0.0, (squares_s2_[longest] - squares_s2_[largest]) / (2.0 * (kSpans[longest] - kSpans[largest])));
}

// A second difference over m scans has the variance 6 R + 2 m Q, with R of a stamp and Q of the time between two scans.
// Bursts let it grow and shrink again, and a drift of the period lets the longest grow: the least growth counts.
double ScanRhythm::learn_gain() const {
  std::size_t spans = 0;
  while (spans < kSpans.size() && total_ > 2 * kSpans[spans] + kSpans[spans] / 2) {
    ++spans;
  }
  if (spans < 3) {
    return 1.0;  // too few scans to tell
  }
  const double uneven_s2 = spans < 4 ? growth_s2(2) : std::min(growth_s2(spans - 1), growth_s2(spans - 2));
  double waver_s2 = 0.0;
  for (std::size_t i = 0; i + 1 < spans; ++i) {
    waver_s2 = std::max(waver_s2, (squares_s2_[i] - 2.0 * kSpans[i] * uneven_s2) / 6.0);
  }
  if (waver_s2 <= 0.0) {
    return 1.0;
  }
  const double ratio = uneven_s2 / waver_s2;
  return std::max(kGain_min, 0.5 * (std::sqrt(ratio * ratio + 4.0 * ratio) - ratio));
}

}  // namespace odoless
