#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/lrf/rplidar/packet.hpp"

namespace odoless::rplidar {

/// Collects the points of a turn, whose number varies, and gives it as a scan of evenly spaced beams.
///
/// The rule: a beam that lies between two points of one surface (their ranges differ by less than a tenth) gets the
/// range at which the straight line through them is hit; between two surfaces, that of the nearer point. Points are
/// neighbours when they are at most one and a half beams, or mean distances of samples, apart; a beam without points
/// near it gets 0: nothing can be said. Samples that nothing answered (range 0) have no direction, for theirs isn't
/// compensated: they lie evenly between the points around them, if none was lost there, and a beam beside one gets
/// infinity.
///
/// Thread: one thread. Real time: no allocation after construction; n log n in the points of a turn.
class Turn {
 public:
  static constexpr std::size_t kPointsMax = 8192;
  static constexpr double kTurnDeg = 360.0;

  /// @param miss_lag_deg  By how much the angle of a sample that nothing answered may be ahead of what a point's
  ///                      would be.
  explicit Turn(double miss_lag_deg = kCompensationMaxDeg);

  /// A point that was measured at `time_ns`. @return whether it is the first of the next turn, and this one complete:
  /// `resample` it now.
  [[nodiscard]] bool add(const Point& point, std::int64_t time_ns);

  /// What is collected may have been wrong.
  void spoil() { is_spoilt_ = true; }

  /// Of the complete turn:
  [[nodiscard]] bool is_whole() const { return complete_.is_whole; }  ///< from its start
  [[nodiscard]] bool is_spoilt() const { return complete_.is_spoilt; }
  [[nodiscard]] std::int64_t start_ns() const { return complete_.start_ns; }  ///< when the front was passed
  [[nodiscard]] std::int64_t period_ns() const { return complete_.period_ns; }

  /// Writes the complete turn's ranges, clockwise from the front. @return beams that something is known of.
  [[nodiscard]] int resample(std::span<float> ranges_m);

  /// Forgets everything.
  void clear();

 private:
  struct Sample {
    double angle_deg = 0.0;  ///< from the turn's start on, without a wrap
    double range_m = 0.0;    ///< 0 only of the first one and of the one that completes a turn
    std::int64_t time_ns = 0;
    std::size_t misses = 0;  ///< samples so far that nothing answered and that aren't kept
  };
  struct Complete {
    bool is_whole = false;
    bool is_spoilt = false;
    std::int64_t start_ns = 0;
    std::int64_t period_ns = 0;
    double sample_deg = 0.0;  ///< from sample to sample
    double sample_ns = 0.0;
  };

  static constexpr double kBackwardsMaxDeg = 30.0;

  void close();
  void push(const Sample& sample);
  [[nodiscard]] float between_m(const Sample& left, const Sample& right, double angle_deg, double beam_deg) const;

  double miss_lag_deg_;
  std::vector<Sample> samples_;   ///< of the turn that is collected; the first is the last one's of the turn before
  std::vector<Sample> finished_;  ///< of the complete turn, with one sample beyond each end
  std::size_t count_ = 0;
  std::size_t finished_count_ = 0;
  std::size_t misses_ = 0;
  double last_deg_ = 0.0;  ///< of the last sample, kept or not
  bool is_whole_ = false;  ///< from its start
  bool is_spoilt_ = false;
  Complete complete_;
};

inline void Turn::push(const Sample& sample) {
  if (count_ == samples_.size()) {
    clear();  // it doesn't turn
  }
  samples_[count_++] = sample;
}

inline bool Turn::add(const Point& point, std::int64_t time_ns) {
  const bool is_miss = point.range_m <= 0.0;
  double angle_deg = point.angle_deg - (is_miss ? miss_lag_deg_ : 0.0);
  if (count_ > 0) {
    const double behind_deg = last_deg_ - angle_deg;
    if (std::abs(behind_deg) >= kTurnDeg / 2.0) {  // rarely
      angle_deg += kTurnDeg * std::round(behind_deg / kTurnDeg);
    }
    if (angle_deg < last_deg_ - kBackwardsMaxDeg) {
      is_spoilt_ = true;
    }
  }
  last_deg_ = angle_deg;
  const bool is_complete = angle_deg >= kTurnDeg;
  if (is_miss && count_ > 0 && !is_complete) {
    ++misses_;
    return false;
  }
  push({angle_deg, point.range_m, time_ns, misses_});
  if (is_complete) {
    close();
  }
  return is_complete;
}

}  // namespace odoless::rplidar
