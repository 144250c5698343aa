#include "rt/latency_histogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace odoless {

void LatencyHistogram::record(std::int64_t latency_ns) {
  ++buckets_[bucket_of(latency_ns)];
  ++count_;
  sum_ns_ += std::clamp<std::int64_t>(latency_ns, 0, kEnd_ns);
  max_ns_ = std::max(max_ns_, latency_ns);
}

std::int64_t LatencyHistogram::percentile(double percent) const {
  if (count_ == 0) {
    return 0;
  }
  const double rank = std::ceil(percent / 100.0 * static_cast<double>(count_));
  const auto wanted = static_cast<std::uint64_t>(std::clamp(rank, 1.0, static_cast<double>(count_)));
  std::uint64_t seen = 0;
  std::size_t bucket = 0;
  for (; bucket < buckets_.size(); ++bucket) {
    seen += buckets_[bucket];
    if (seen >= wanted) {
      break;
    }
  }
  return std::min(middle_ns(bucket), max_ns_);
}

std::size_t LatencyHistogram::bucket_of(std::int64_t latency_ns) {
  constexpr std::int64_t kMicrosecond_ns = 1000;
  const auto ns = static_cast<std::uint64_t>(std::clamp(latency_ns, kMicrosecond_ns, kEnd_ns - 1));
  const int doubling = static_cast<int>(std::bit_width(ns)) - 1;
  const std::uint64_t part = (ns >> (doubling - 4)) - kSplit;  // the four bits after the first
  return static_cast<std::size_t>(doubling - kFirstDoubling) * kSplit + part;
}

std::int64_t LatencyHistogram::width_ns(std::size_t bucket) {
  return std::int64_t{1} << (static_cast<int>(bucket / kSplit) + kFirstDoubling - 4);
}

std::int64_t LatencyHistogram::end_ns(std::size_t bucket) {
  return (kSplit + static_cast<std::int64_t>(bucket % kSplit) + 1) * width_ns(bucket);
}

std::int64_t LatencyHistogram::middle_ns(std::size_t bucket) { return end_ns(bucket) - width_ns(bucket) / 2; }

}  // namespace odoless
