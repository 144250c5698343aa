#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/result.hpp"
#include "drivers/lrf/scip/reply_reader.hpp"

namespace odoless::scip {

/// The two characters of a status, the first in the higher byte, such as 0x3030 for "00".
using Status = int;

[[nodiscard]] constexpr Status status(const char (&two)[3]) { return two[0] * 256 + two[1]; }

/// The status of a reply. Errc::kFrameTruncated, kFrameMalformed, kWrongSum.
[[nodiscard]] Result<Status> status_of(const Reply& reply);

/// Whether a device answered in SCIP 1.1, which knows no check sums: an echo and "E" or one digit.
[[nodiscard]] bool is_scip1(const Reply& reply);

/// What PP says; ranges in mm, steps of the full circle.
struct Parameters {
  int range_min_mm = 0;      ///< DMIN: smaller ranges are error codes
  int range_max_mm = 0;      ///< DMAX
  int steps_per_turn = 0;    ///< ARES
  int first_step = 0;        ///< AMIN
  int last_step = 0;         ///< AMAX
  int front_step = 0;        ///< AFRT
  int turns_per_minute = 0;  ///< SCAN
  bool is_urg = false;       ///< by MODL: its error codes differ from those of the larger lasers
};

/// Reads a reply to PP. Errc::kDeviceStatus, kFrameTruncated (a key is missing), kFrameMalformed, kWrongSum,
/// kBadGeometry (figures that no laser can have).
[[nodiscard]] Result<Parameters> parameters_of(const Reply& reply);

/// Which of a beam's echoes makes its range, where the laser tells several.
enum class EchoChoice : std::uint8_t {
  kOnly,       ///< it tells one
  kLast,       ///< the farthest
  kStrongest,  ///< the one of the highest intensity
};

/// Most echoes of a beam that a laser tells.
inline constexpr std::size_t kEchoesMax = 3;

/// What one scan of a running stream looks like.
struct ScanFormat {
  std::string_view echo;  ///< the request, as the laser repeats it above each scan
  std::size_t characters_per_value = 3;
  std::size_t values_per_beam = 1;  ///< 2: range and intensity
  std::size_t beams = 0;
  EchoChoice choice = EchoChoice::kOnly;

  /// Characters of one echo.
  [[nodiscard]] constexpr std::size_t width() const { return characters_per_value * values_per_beam; }
  /// Characters of the data, without sums: of one echo a beam, and of as many as there can be, with '&' between them.
  [[nodiscard]] constexpr std::size_t fewest_characters() const { return beams * width(); }
  [[nodiscard]] constexpr std::size_t most_characters() const {
    return choice == EchoChoice::kOnly ? fewest_characters() : beams * (kEchoesMax * (width() + 1) - 1);
  }
};

/// A scan's stamp and its ranges as the device gives them, error codes and all.
struct RawFrame {
  std::uint32_t stamp_ms = 0;
  std::span<const std::uint32_t> ranges_mm{};
};

/// Memory that a scan is read in.
struct ScanRoom {
  std::span<char> data;                ///< at least `most_characters`
  std::span<std::uint32_t> ranges_mm;  ///< at least `beams`
};

/// Reads one scan of the stream.
///
/// Everything that the sums, which have but 6 bits, let through is held against what was asked for: the echo, the
/// status, the length of every line and with it the number of beams.
/// Errors: Errc::kWrongEcho, kDeviceStatus (any but 99), kWrongSum, kWrongCount, kFrameMalformed, kFrameTruncated.
/// Real time: no allocation; linear in the reply.
[[nodiscard]] Result<RawFrame> scan_of(const Reply& reply, const ScanFormat& format, const ScanRoom& room);

}  // namespace odoless::scip
