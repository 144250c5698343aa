#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "core/scan/scan_rhythm.hpp"
#include "core/scan/scan_time.hpp"

namespace odoless {

/// From the stamps of scans, in the order of the scans, to the times at which they were taken.
///
/// A laser turns steadily; stamps may be of the computer that was late to note them. Several accounts of the stamps are
/// kept: the rhythm goes on and a stamp is late, or early; scans are missing; the clock was set. Each next stamp says
/// which is right, and how often each was right so far says what to think of the next jump. The likeliest account
/// gives the time, the others its uncertainty. Steady stamps come out as told.
///
/// Causal; the order of the scans is taken for right. Any stamps whatever give times that grow.
/// Thread: owned by one thread. Real time: no allocation; bounded time.
class ScanClock {
 public:
  static constexpr std::int64_t kNoArrival = std::numeric_limits<std::int64_t>::min();

  /// @param arrival_ns  When the scan came in, where it came as it was taken: tells a gap from a clock that was set.
  [[nodiscard]] ScanTime next(std::int64_t stamp_ns, std::int64_t arrival_ns = kNoArrival);

  [[nodiscard]] const ScanTimeFindings& findings() const { return findings_; }

 private:
  enum class Origin : std::uint8_t { kRhythm, kGap, kSlip, kClockSet };

  /// One account of the stamps.
  struct Account {
    double time_s = 0.0;        ///< of the last scan, since the first stamp
    std::int64_t ahead_ns = 0;  ///< by how much the clock of the stamps was set
    double left_out_s = 0.0;    ///< gaps and jumps, which the rhythm is not told
    double log_weight = 0.0;
    double gap_s = 0.0;     ///< that it began with
    double off_s = 0.0;     ///< the last stamp from the rhythm
    std::int64_t born = 0;  ///< scan
    Origin origin = Origin::kRhythm;
    bool is_off = false;  ///< the last stamp is rather of something else than of the rhythm

    /// The last scan's time by the clock of the stamps.
    [[nodiscard]] double phase_s() const { return time_s + 1e-9 * static_cast<double>(ahead_ns); }
  };
  /// How often what happens, in so many scans.
  struct Habits {
    double gaps = 1.0;
    double late = 0.3;
    double early = 0.1;
    double clock_sets = 0.01;
    double off_s = 0.5;  ///< usual delay of a late stamp
    double scans = 100.0;
  };
  static constexpr int kAccountsMax = 6;

  [[nodiscard]] double period_s() const;
  [[nodiscard]] double gate_s() const;  ///< of a stamp that may be of a jump
  [[nodiscard]] double gain(const Account& account) const;
  [[nodiscard]] double since_start_s(std::int64_t stamp_ns, std::int64_t ahead_ns) const;
  void extend(std::int64_t stamp_ns, double arrived_after_s);
  [[nodiscard]] Account gone_on(const Account& account, double off_s) const;
  [[nodiscard]] bool is_gap(double off_s, double arrived_after_s) const;
  [[nodiscard]] Account jumped(const Account& account, double off_s, double arrived_after_s) const;
  void offer(const Account& account);
  void follow(const Account& believed);
  void settle(const Account& account);
  void learn();
  [[nodiscard]] ScanTime tell(std::int64_t stamp_ns) const;
  [[nodiscard]] double variance_s2(double said_s) const;
  [[nodiscard]] double waver_s2() const;
  [[nodiscard]] double jump_doubt_s(double said_s) const;
  [[nodiscard]] std::uint8_t order_flags(std::int64_t stamp_ns) const;
  void count(const ScanTime& time);

  ScanRhythm rhythm_;
  Habits habits_;
  ScanTimeFindings findings_;
  std::array<Account, kAccountsMax> accounts_{};  ///< the likeliest first
  int account_count_ = 0;
  std::int64_t opened_ = -1;   ///< scan of the jump of which it is not known what it was; -1: none
  double opened_off_s_ = 0.0;  ///< of that scan from the rhythm
  bool is_too_near_ = false;   ///< the scan's stamp to that of the scan before, for both to be right
  bool may_be_gap_ = false;    ///< although it is rather a late stamp
  double expected_s_ = 0.0;    ///< from the last scan to this one
  double off_sd_s_ = 0.0;      ///< of stamps that are not off, from the rhythm
  std::int64_t origin_ns_ = 0;
  std::int64_t stamp_ns_ = 0;  ///< of the last scan, as told
  std::int64_t arrival_ns_ = kNoArrival;
  std::int64_t time_ns_ = 0;  ///< of the last scan, as said
};

}  // namespace odoless
