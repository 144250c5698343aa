#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "firmware/lcm/channels.hpp"
#include "firmware/lcm/decode.hpp"
#include "firmware/lcm/lcm_receiver.hpp"
#include "firmware/stages/scan_source.hpp"

namespace odoless {

/// Scans, and perhaps motions, from LCM: another driver's planar_lidar_t, a log that lcm-logplayer plays, or the
/// matcher of this robot in another process, of which what was lost comes again.
///
/// Thread: sensor thread. Real time: system calls recvfrom and those of the sink.
class LcmSource final : public ScanSource {
 public:
  /// Scans alone, from any channel.
  LcmSource(const LcmParams& params, const std::string& scan_channel, int beams_max);
  /// Scans and motions of a matcher elsewhere.
  LcmSource(const LcmParams& params, const Channels& channels, int beams_max);

  /// Joins the group. Errc::kBadAddress or Errc::kUnavailable; `reason` then says more. Not for a real-time thread.
  [[nodiscard]] Errc open() { return receiver_.open(); }
  [[nodiscard]] const std::string& reason() const { return receiver_.reason(); }

  [[nodiscard]] int descriptor() const override { return receiver_.descriptor(); }
  [[nodiscard]] std::int64_t next_deadline_ns() const override { return kNever_ns; }
  void work(const Clock& clock, ScanSink& sink) override;
  [[nodiscard]] bool is_open() const override { return receiver_.descriptor() >= 0; }
  [[nodiscard]] bool is_live() const override { return false; }  // a log that is played bears the time of its record
  void add_counts(SourceHealth& health) const override;

 private:
  static constexpr int kMessagesPerRound = 64;
  struct Names {
    std::string scan{};
    std::string scan_times{};
    std::string scan_again{};
    std::string motion{};
    std::string motion_again{};
  };

  LcmSource(const LcmParams& params, Names names, int beams_max);
  void take_scan(const LcmMessage& message, ScanSink& sink);
  void take_scan_times(const LcmMessage& message);
  void take_motion(const LcmMessage& message, ScanSink& sink);

  Names names_;
  LcmReceiver receiver_;
  std::vector<float> ranges_m_;
  ScanTimes times_;                                                       ///< of scans from now on
  std::int64_t last_scan_ns_ = std::numeric_limits<std::int64_t>::min();  ///< stamps
  std::int64_t last_motion_ns_ = std::numeric_limits<std::int64_t>::min();
  std::int64_t refused_ = 0;
  std::int64_t motions_refused_ = 0;
};

}  // namespace odoless
