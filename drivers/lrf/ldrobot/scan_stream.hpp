#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "drivers/lrf/arrival_clock.hpp"
#include "drivers/lrf/ldrobot/packet.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/turn_scans.hpp"

namespace odoless::ldrobot {

/// What a sample takes, by a packet's angles and its speed: that of the LD06 and LD19, or of the STL-27L, whichever is
/// nearer.
[[nodiscard]] std::int64_t sample_ns_of(const Packet& packet);

/// The stream of turns of one device.
///
/// It samples evenly and counts milliseconds, which tell how many samples lie between two packets, lost ones too: the
/// samples' number is the time, the counter's rate its scale, and the arrivals its origin. Beams go clockwise from the
/// front, so the angle step is negative.
/// Thread: one thread. Real time: no allocation after construction.
class ScanStream {
 public:
  ScanStream(const LrfParams& params, int beams_max);

  /// A stream is about to start, of which `packet` was one. Errc::kTooManyBeams: more than there is memory for.
  [[nodiscard]] Errc configure(const Packet& packet, int line_baud);

  [[nodiscard]] const LrfGeometry& geometry() const { return scans_.geometry(); }

  /// Takes bytes off the front of `bytes`, up to the end of a turn or the first fault. A scan, or why there is none:
  /// Errc::kOk (all bytes are used), kWrongSum, kFrameMalformed (bytes had to be skipped), kWrongCount (a turn that
  /// lacks too many points, or of which something may have been wrong).
  [[nodiscard]] FoundScan take(std::span<const std::byte>& bytes, std::int64_t arrival_ns);

  [[nodiscard]] std::uint64_t identical_run() const { return scans_.identical_run(); }

 private:
  void on_packet(std::int64_t arrival_ns);
  void learn_rate(std::int64_t elapsed_ms, std::int64_t packets);
  [[nodiscard]] bool take_points();

  TurnScans scans_;
  PacketReader reader_;
  ArrivalClock clock_{250'000'000};
  std::int64_t nominal_ns_ = 0;  ///< of a sample
  double sample_ns_ = 0.0;
  std::int64_t transfer_ns_ = 0;
  std::optional<int> counter_ms_;  ///< of the last packet
  double device_ns_ = 0.0;         ///< of its last sample, by the samples' number
  std::int64_t counted_ms_ = 0;    ///< since the rate was learnt last
  std::int64_t counted_packets_ = 0;
  std::size_t next_point_ = kPacketPoints;  ///< of the packet; the rest waits for the next call
};

}  // namespace odoless::ldrobot
