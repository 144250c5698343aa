#pragma once

#include <array>
#include <cstddef>

namespace odoless {

/// What the stamps of late say of the laser's period, and of how they waver about it. Fed with continuous stamps: who
/// feeds it takes gaps out first.
///
/// The period is the median slope over half a window [theil1950rank; method 1], which a quarter of wrong stamps does
/// not move. Whether stamps waver about a steady clock, or the scans themselves come unevenly, is told by second
/// differences over 1 to 16 scans: those of an error of the stamp alone stay as they are, those of uneven scans grow
/// with the span.
///
/// Thread: owned by one thread. Real time: no allocation; time bounded by the window.
class ScanRhythm {
 public:
  static constexpr int kWindow = 64;

  /// The next scan's stamp, since any origin.
  void add(double stamp_s);
  /// Adds `by_s` to the last `scans` stamps: a gap among them was none, or one was not seen.
  void move_last(int scans, double by_s);

  [[nodiscard]] bool is_known() const { return scans_ >= 2; }
  /// Of the laser; at least kPeriod_min_s.
  [[nodiscard]] double period_s() const { return period_s_; }
  /// Share of a stamp's deviation from the rhythm that is believed: 1 where scans come unevenly, little where stamps
  /// waver (the gain of a Kalman filter in its steady state).
  [[nodiscard]] double gain() const { return gain_; }

  static constexpr double kPeriod_min_s = 0.004;

 private:
  static constexpr std::array<int, 5> kSpans{1, 2, 4, 8, 16};

  /// The stamp `back` scans ago.
  [[nodiscard]] double at(int back) const {
    return stamps_s_[(static_cast<std::size_t>(scans_ - 1 - back)) % static_cast<std::size_t>(kWindow)];
  }
  [[nodiscard]] int held() const { return scans_ < kWindow ? scans_ : kWindow; }
  [[nodiscard]] double median_slope_s() const;
  void learn_differences();
  [[nodiscard]] double growth_s2(std::size_t longest) const;
  [[nodiscard]] double learn_gain() const;

  std::array<double, kWindow> stamps_s_{};
  std::array<double, kSpans.size()> squares_s2_{};  ///< of second differences, averaged
  int scans_ = 0;                                   ///< wraps to twice the window
  int total_ = 0;                                   ///< stops at kMemory
  double period_s_ = kPeriod_min_s;
  double gain_ = 1.0;
};

}  // namespace odoless
