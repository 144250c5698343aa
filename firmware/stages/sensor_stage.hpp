#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "core/scan/laser_mount.hpp"
#include "core/scan/scan_clock.hpp"
#include "core/scan/scan_frame.hpp"
#include "core/scan/stuck_detector.hpp"
#include "firmware/pipeline/messages.hpp"

namespace odoless {

/// Why a scan is not taken in.
enum class ScanVerdict { kAccepted, kMalformed, kDuplicate, kOutOfOrder, kLate, kNotLevel };

/// Says which scans go on to the matcher, when they were taken, and what the stream of scans is like.
///
/// A live source's scan that is not the next one is refused: the robot has moved on. A recorded log's scans are all
/// there and in their order, whatever their stamps say: each is taken and timed, but for one that is there twice.
///
/// Thread: sensor thread. Real time: no allocation after construction; time linear in the beams.
class SensorStage {
 public:
  /// @param live  Scans come as they are taken, and bear the time of now: what is late or out of order is refused.
  SensorStage(bool live, int beams_max, const LaserMountParams& mount = {})
      : live_(live), mount_(mount, beams_max), stuck_(beams_max) {}

  /// Puts an accepted scan into `frame`, as it is mounted and with its time; leaves the frame as it was otherwise.
  /// @param raw  As the laser says it.
  [[nodiscard]] ScanVerdict process(const RawScan& raw, std::int64_t now_ns, ScanFrame& frame);

  /// Of ranges as the laser says them, those in sectors that are ignored become 0.
  void mask(const RawScan& raw, std::span<float> ranges_m) { mount_.mask(raw, ranges_m); }

  [[nodiscard]] const SourceHealth& counts() const { return counts_; }
  [[nodiscard]] std::int64_t last_scan_ns() const { return last_scan_ns_; }
  /// Of the laser, as estimated; 0: not known.
  [[nodiscard]] std::int64_t period_ns() const { return std::llround(counts_.times.period_s * 1e9); }
  [[nodiscard]] bool is_blind() const { return blind_in_a_row_ >= kBlindScans; }
  [[nodiscard]] bool is_stuck() const { return stuck_in_a_row_ >= kStuckScans; }

  static constexpr std::int64_t kLate_ns = 500'000'000;  ///< older scans say nothing about now
  static constexpr int kAnewScans = 10;  ///< older ones in a row, in their own order: a source that began anew
  static constexpr int kBlindScans = 3;
  static constexpr int kStuckScans = 2;        ///< that repeat the one before
  static constexpr double kBlindShare = 0.05;  ///< of the beams; with fewer returns a scan is blind

 private:
  [[nodiscard]] ScanVerdict judge(const RawScan& raw, std::uint64_t digest, std::int64_t now_ns);
  /// Whether the source's clock went back for good, as when a log is played again.
  [[nodiscard]] bool begins_anew(std::int64_t stamp_ns);
  void observe(const RawScan& raw, std::uint64_t digest, std::int64_t now_ns, ScanFrame& frame);

  bool live_;
  LaserMount mount_;
  SourceHealth counts_;
  ScanClock clock_;
  std::int64_t last_stamp_ns_ = std::numeric_limits<std::int64_t>::min();
  std::int64_t last_scan_ns_ = 0;
  std::int64_t last_earlier_ns_ = 0;
  int earlier_in_a_row_ = 0;
  std::uint64_t last_digest_ = 0;
  StuckDetector stuck_;
  int stuck_in_a_row_ = 0;
  std::int64_t last_time_ns_ = 0;  ///< of the last scan
  std::int64_t seen_ns_ = 0;       ///< of the last one that no stuck laser can have sent
  int blind_in_a_row_ = 0;
};

}  // namespace odoless
