#pragma once

#include <cstddef>
#include <cstdint>

#include "drivers/lrf/arrival_clock.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/range_buffer.hpp"
#include "drivers/lrf/sick/telegram.hpp"

namespace odoless::sick {

inline constexpr int kScanReply = 0xB0;

/// A field of view and a step, both in hundredths of a degree, as the device is told them.
struct Variant {
  int field_of_view_cdeg = 18000;
  int step_cdeg = 50;

  [[nodiscard]] int beams() const { return field_of_view_cdeg / step_cdeg + 1; }
  /// Turns of the mirror that one scan takes; between them, the beams are shifted by a part of a degree.
  [[nodiscard]] int turns() const { return 100 / step_cdeg; }
  [[nodiscard]] std::size_t payload_bytes() const { return 1 + 2 + 2 * static_cast<std::size_t>(beams()) + 1; }
};

[[nodiscard]] Variant variant_of(SickVariant name);

inline constexpr std::int64_t kTurnNs = 13'333'333;  ///< 75 Hz

/// The stream of scans of one device, and what its telegrams mean.
///
/// The device sends no stamp. Its mirror turns evenly, a telegram starts when a scan is complete, and the line has a
/// known rate: so the moment of the last beam is the arrival less the transfer, evened out over the turns since the
/// scan before. How long the device thinks is unknown, and shifts all stamps by the same.
/// Thread: one thread. Real time: no allocation after construction.
class ScanStream {
 public:
  ScanStream(const LrfParams& params, int beams_max);

  /// The device is set otherwise than wished for, and that is to hold.
  void take_over(SickVariant variant, SickUnit unit);

  /// Fits the stamps to a line rate. 0: unknown, so that stamps are late by the time that the line takes.
  /// Errc::kTooManyBeams: more than there is memory for.
  [[nodiscard]] Errc configure(int line_baud);

  [[nodiscard]] const Variant& variant() const { return variant_; }
  [[nodiscard]] const LrfGeometry& geometry() const { return geometry_; }

  /// One scan, from a telegram with kScanReply that came at `arrival_ns`. Errc::kWrongCount (another number of beams),
  /// kFrameMalformed (another unit, or a part of a scan).
  [[nodiscard]] Result<LrfScan> scan(const Telegram& telegram, std::int64_t arrival_ns);

  [[nodiscard]] std::uint64_t identical_run() const { return buffer_.identical_run(); }

 private:
  [[nodiscard]] Errc check_head(std::span<const std::byte> data) const;
  [[nodiscard]] std::int64_t stamp_ns(std::int64_t arrival_ns);
  [[nodiscard]] float range_m(unsigned value) const;

  Variant variant_;
  SickUnit unit_;
  LrfGeometry geometry_;
  RangeBuffer buffer_;
  ArrivalClock clock_{1'000'000'000};
  std::int64_t way_ns_ = 0;         ///< from the first beam to the arrival, when nothing is late
  bool is_first_ = true;            ///< of this stream
  std::int64_t turns_ = 0;          ///< of the mirror, up to the last scan
  std::int64_t last_stamp_ns_ = 0;  ///< 0: none
};

}  // namespace odoless::sick
