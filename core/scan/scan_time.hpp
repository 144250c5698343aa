#pragma once

#include <cstdint>

namespace odoless {

/// What is doubtful about a scan's time; bits.
enum ScanTimeFlag : std::uint8_t {
  kTimeMoved = 1U << 0,       ///< not the time as told
  kTimeOutOfOrder = 1U << 1,  ///< told to be older than the scan before
  kTimeBunched = 1U << 2,     ///< told to be of the same time as the scan before, or nearly
  kTimeJumped = 1U << 3,      ///< the stamp is off the rhythm: a gap, or a stamp that is late; the next scans will tell
  kTimeClockSet = 1U << 4,    ///< the clock of the stamps was set before this scan
  kTimeDoubtful = 1U << 5,    ///< uncertain by more than a quarter of the period
};

/// When a scan was taken, as well as can be told.
struct ScanTime {
  std::int64_t time_ns = 0;  ///< later than that of the scan before; begins as the stamps do
  /// Standard deviation against the scans about it: the time between two scans is uncertain by the root of the sum of
  /// both squares.
  double sd_s = 0.0;
  std::uint8_t flags = 0;  ///< of ScanTimeFlag
};

/// What the stamps of a stream were like, since start.
struct ScanTimeFindings {
  std::int64_t scans = 0;
  std::int64_t out_of_order = 0;  ///< told to be older than the one before
  std::int64_t bunched = 0;       ///< told to be within a tenth of the period after the one before
  std::int64_t gaps = 0;          ///< scans that are missing, one or many
  std::int64_t clock_sets = 0;    ///< jumps of the stamps that no time stands behind
  std::int64_t moved = 0;         ///< given another time than told
  std::int64_t doubtful = 0;      ///< uncertain by more than a quarter of the period
  double longest_gap_s = 0.0;
  double period_s = 0.0;  ///< as estimated last; 0: not known
  double waver_s = 0.0;   ///< usual deviation of a stamp from the rhythm
};

}  // namespace odoless
