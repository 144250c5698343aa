#pragma once

#include <cstddef>
#include <span>

#include "core/base/result.hpp"
#include "core/scan/scan_frame.hpp"
#include "firmware/records/records.hpp"

namespace odoless {

/// Messages from a network to records: what comes in here may have been made by anybody.
///
/// Whatever the bytes are, these return a record whose numbers are finite and sane, or say why not:
/// Errc::kUnknownType (fingerprint of another message), Errc::kMalformed (cut short, too long for its own
/// counts, or a count below zero), Errc::kTooLong (more of something than there is room for), Errc::kBadNumber (a
/// number that is not finite, denormal, negative where it cannot be, or beyond all that a robot does).
///
/// Real time: no allocation, no system call; linear in the message.

/// A bot_core.planar_lidar_t. Ranges are copied to `ranges_m`, which must outlive the scan; one that is not a number,
/// negative or denormal becomes 0: nothing is known of that beam. Infinity stays: no return. Intensities are skipped.
[[nodiscard]] Result<RawScan> decode_scan(std::span<const std::byte> message, std::span<float> ranges_m);

/// When the beams of a scan are measured.
struct ScanTimes {
  std::int64_t first_beam_ns = 0;   ///< after the scan's stamp
  std::int64_t beam_period_ns = 0;  ///< as RawScan has it
};

/// An odoless.scan_times_t. Errc::kBadNumber where a beam is more than a second from its scan's stamp or the next beam.
[[nodiscard]] Result<ScanTimes> decode_scan_times(std::span<const std::byte> message);

/// An odoless.motion_t: what was a Motion, bit for bit, with stamps of whole microseconds. Errc::kTooLong where it has
/// more alternatives than one can have. Its covariance is skipped, as it follows from the rest.
[[nodiscard]] Result<Motion> decode_motion(std::span<const std::byte> message);

}  // namespace odoless
