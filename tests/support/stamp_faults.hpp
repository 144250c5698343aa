#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace odoless::test {

/// Stamps as a busy computer notes them that stalls now and then, of scans that were really taken at `true_ns`, in the
/// order of the scans. Of scans 0.2 s apart 4.6 % are told to be older than the one before, by up to 0.6 s, 28 % to be
/// within 10 ms of it, and 3 % more than 1 s after it: as in a recorded log of an office.
/// The same seed gives the same stamps.
[[nodiscard]] std::vector<std::int64_t> waver(std::span<const std::int64_t> true_ns, std::uint64_t seed);

/// Stamps of scans that came in bursts of `least` to `most`: all of a burst bear the time at which its last one was
/// taken, a tenth of a millisecond apart.
[[nodiscard]] std::vector<std::int64_t> bunch(std::span<const std::int64_t> true_ns, int least, int most,
                                              std::uint64_t seed);

/// Times `period_ns` apart.
[[nodiscard]] std::vector<std::int64_t> even_times(int scans, std::int64_t period_ns, std::int64_t first_ns = 0);

/// How stamps look, counted as people count them in a log.
struct StampCounts {
  int out_of_order = 0;
  double most_back_s = 0.0;
  int within_10_ms = 0;
  int gaps_above_1_s = 0;
};
[[nodiscard]] StampCounts count_stamps(std::span<const std::int64_t> stamps_ns);

}  // namespace odoless::test
