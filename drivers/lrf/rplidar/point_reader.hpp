#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/lrf/rplidar/capsule.hpp"
#include "drivers/lrf/rplidar/packet.hpp"

namespace odoless::rplidar {

/// Cuts a stream into points, and counts the samples that it stands for.
///
/// The standard scan has no sums, only two check bits in each five bytes. So the reader is in step only after eight
/// nodes in a row whose bits are right and whose angles go on as the mirror does, give or take what the device may have
/// compensated them by, and out of step with the first that doesn't fit; what
/// was received meanwhile is kept, so that the step is found again at the very next node. Capsules have marks and sums
/// of 8 bits, and one must go on where the one before ended; its points wait for the next capsule, which tells how far
/// the mirror has turned. Thread: one thread. Real time: no allocation; linear in the bytes.
class PointReader {
 public:
  enum class Outcome {
    kMore,      ///< all bytes are used
    kPoints,    ///< `points` are new
    kSkipped,   ///< bytes were thrown away; of what came since the last points, something may have been wrong
    kWrongSum,  ///< a capsule's sum is wrong
    kBroken,    ///< what comes doesn't go on where the last points were
  };

  /// A new stream of capsules, or of nodes where there is no format; what was received is forgotten.
  void start(const CapsuleFormat* format);

  [[nodiscard]] Outcome take(std::span<const std::byte>& bytes);

  [[nodiscard]] std::span<const Point> points() const { return {points_.data(), point_count_}; }
  /// Number of the first of the points among all samples of the stream, lost ones counted by their bytes.
  [[nodiscard]] std::int64_t first_sample() const { return first_sample_; }
  /// Number of the last sample that has arrived.
  [[nodiscard]] std::int64_t last_sample() const;

  /// Of a node or capsule.
  [[nodiscard]] std::size_t packet_bytes() const { return format_ == nullptr ? kNodeBytes : format_->bytes; }

 private:
  static constexpr std::size_t kTrialNodes = 8;

  [[nodiscard]] std::span<const std::byte> rest() const { return std::span(bytes_).subspan(begin_, end_ - begin_); }
  [[nodiscard]] std::span<const std::byte> before() const { return std::span(before_).first(format_->bytes); }
  [[nodiscard]] Outcome inspect();
  [[nodiscard]] Outcome take_node();
  [[nodiscard]] bool is_in_step() const;
  [[nodiscard]] Outcome take_capsule();
  [[nodiscard]] bool follows_before(std::span<const std::byte> capsule, double sweep_deg) const;
  [[nodiscard]] Outcome on_capsule(std::span<const std::byte> capsule, double sweep_deg);
  [[nodiscard]] std::int64_t packet_points() const { return format_ == nullptr ? 1 : format_->points; }
  [[nodiscard]] std::int64_t capsules_since_before() const;
  [[nodiscard]] bool is_before_too_old() const;
  [[nodiscard]] double sweep_deg(std::span<const std::byte> capsule) const;
  [[nodiscard]] Outcome skip_one(Outcome outcome);
  void use(std::size_t bytes);
  [[nodiscard]] std::int64_t sample_after(std::size_t bytes) const;

  const CapsuleFormat* format_ = nullptr;  ///< null: nodes
  std::array<std::byte, 4 * kCapsuleBytesMax> bytes_{};
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::int64_t used_bytes_ = 0;  ///< of the stream
  bool in_step_ = false;
  bool skipping_ = false;      ///< told already
  std::optional<Point> last_;  ///< of those in step

  std::array<std::byte, kCapsuleBytesMax> before_{};  ///< the capsule whose points wait
  std::int64_t before_sample_ = 0;
  bool has_before_ = false;
  bool is_before_suspect_ = false;
  double sweep_deg_ = 0.0;  ///< of the last capsule; 0: not known yet
  int misfits_ = 0;         ///< in a row

  std::array<Point, kCapsulePointsMax> points_{};
  std::size_t point_count_ = 0;
  std::int64_t first_sample_ = 0;
};

}  // namespace odoless::rplidar
