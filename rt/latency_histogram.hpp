#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace odoless {

/// How long something took, over many times, in fixed memory: buckets that grow with the duration, 16 per doubling,
/// from 1 us to over 100 s.
///
/// A percentile is right within 1/32 (3.2 %) of itself between 1 us and 100 s; shorter ones count as 1 us. Trivially
/// copyable (1.8 kB): goes through a LatestValue.
///
/// Thread:    one.
/// Real time: `record` is a few instructions.
class LatencyHistogram {
 public:
  void record(std::int64_t latency_ns);

  /// The shortest recorded duration that `percent` of all don't exceed (nearest rank); 0 if there is none.
  ///
  /// @param percent  0..100.
  [[nodiscard]] std::int64_t percentile(double percent) const;

  /// The longest of all, exactly; 0 if there is none.
  [[nodiscard]] std::int64_t max() const { return max_ns_; }

  [[nodiscard]] std::uint64_t count() const { return count_; }

  /// 0 if there is none; what is longer than 137 s counts as that.
  [[nodiscard]] std::int64_t mean() const { return count_ == 0 ? 0 : sum_ns_ / static_cast<std::int64_t>(count_); }

  /// The buckets in ascending order: how many durations each has, and where it ends.
  static constexpr std::size_t buckets() { return std::size_t{kSplit} * kDoublings; }
  [[nodiscard]] std::uint32_t count_in(std::size_t bucket) const { return buckets_[bucket]; }
  static std::int64_t end_ns(std::size_t bucket);

 private:
  static constexpr int kSplit = 16;         ///< buckets per doubling
  static constexpr int kFirstDoubling = 9;  ///< 512 ns: the first below a microsecond
  static constexpr int kDoublings = 28;     ///< to 2^37 ns = 137 s
  static constexpr std::int64_t kEnd_ns = std::int64_t{1} << (kFirstDoubling + kDoublings);

  static std::size_t bucket_of(std::int64_t latency_ns);
  static std::int64_t width_ns(std::size_t bucket);
  static std::int64_t middle_ns(std::size_t bucket);

  std::array<std::uint32_t, static_cast<std::size_t>(kSplit* kDoublings)> buckets_{};
  std::uint64_t count_ = 0;
  std::int64_t sum_ns_ = 0;
  std::int64_t max_ns_ = 0;
};

}  // namespace odoless
