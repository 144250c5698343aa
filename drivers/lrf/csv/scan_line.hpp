#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"

namespace odoless::csv {

/// How the beams of a line lie.
struct ScanShape {
  int beams = 0;
  double start_angle_rad = 0.0;
  double angle_step_rad = 0.0;
  double beam_period_s = 0.0;  ///< 0: not told
  friend bool operator==(const ScanShape&, const ScanShape&) = default;
};

/// What a line says, besides its ranges.
struct ScanLine {
  std::optional<double> stamp_s;  ///< of the first beam, on whatever clock
  ScanShape shape;
};

/// Reads "scan,STAMP_S,START_ANGLE_RAD,ANGLE_STEP_RAD,BEAM_PERIOD_S,RANGE_M,RANGE_M,...". STAMP_S and BEAM_PERIOD_S may
/// be empty. A range that is "inf" is none within reach; one that is empty, "nan", zero or less is not known.
/// @param ranges_m  Takes the ranges as LrfScan has them.
///
/// Errors: Errc::kFrameMalformed, kBadGeometry (angles or times that cannot be), kTooManyBeams.
/// Real time: linear in the line.
[[nodiscard]] Result<ScanLine> scan_line_of(std::string_view line, std::span<float> ranges_m);

/// Cuts received bytes into lines. Thread: one thread. Real time: no allocation after construction; linear.
class LineReader {
 public:
  enum class Outcome {
    kMore,     ///< all bytes are used, and no line is complete
    kLine,     ///< `line` is complete
    kSkipped,  ///< a line was longer than any that can be, and was thrown away
  };

  explicit LineReader(std::size_t line_max_bytes) : bytes_(line_max_bytes) {}

  /// Takes bytes off the front of `bytes`, up to the end of a line.
  [[nodiscard]] Outcome take(std::span<const std::byte>& bytes);
  /// Without its end. Valid until the next call.
  [[nodiscard]] std::string_view line() const { return {bytes_.data(), done_bytes_}; }
  void clear() { size_ = 0; }

 private:
  std::vector<char> bytes_;
  std::size_t size_ = 0;  ///< more than there is room for: the rest of the line is thrown away, too
  std::size_t done_bytes_ = 0;
};

}  // namespace odoless::csv
