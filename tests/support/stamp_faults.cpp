#include "tests/support/stamp_faults.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/rng.hpp"

namespace odoless::test {
namespace {

std::int64_t to_ns(double time_s) { return std::llround(time_s * 1e9); }

// Scans that are taken while the computer stalls are noted when it goes on, within milliseconds.
struct Stalls {
  double long_share;   // of the scans at which one of 1.0 to 1.4 s begins
  double short_share;  // and one of 0.3 to 0.7 s
};

}  // namespace

std::vector<std::int64_t> waver(std::span<const std::int64_t> true_ns, std::uint64_t seed) {
  constexpr Stalls kStalls{.long_share = 0.040, .short_share = 0.10};
  constexpr double kDelayed_share = 0.075;  // of the other scans, each by itself
  Rng rng(seed, 77);
  std::vector<std::int64_t> stamps_ns(true_ns.begin(), true_ns.end());
  std::int64_t stalled_until_ns = 0;
  std::int64_t noted_ns = 0;
  bool stalled = false;
  for (std::size_t i = 0; i < true_ns.size(); ++i) {
    if (stalled && true_ns[i] < stalled_until_ns) {
      noted_ns += to_ns(rng.uniform(0.0005, 0.006));
      stamps_ns[i] = noted_ns;
      continue;
    }
    stalled = false;
    const double chance = rng.uniform();
    if (chance < kStalls.long_share + kStalls.short_share) {
      const bool is_long = chance < kStalls.long_share;
      stalled_until_ns = true_ns[i] + to_ns(is_long ? rng.uniform(0.95, 1.4) : rng.uniform(0.25, 0.7));
      noted_ns = stalled_until_ns;
      stamps_ns[i] = noted_ns;
      stalled = true;
    } else if (chance < kStalls.long_share + kStalls.short_share + kDelayed_share) {
      stamps_ns[i] = true_ns[i] + to_ns(rng.uniform(0.2, 0.8));
    } else {
      stamps_ns[i] = true_ns[i] + to_ns(std::abs(0.02 * rng.normal()));
    }
  }
  return stamps_ns;
}

std::vector<std::int64_t> bunch(std::span<const std::int64_t> true_ns, int least, int most, std::uint64_t seed) {
  constexpr std::int64_t kApart_ns = 100'000;
  Rng rng(seed, 78);
  std::vector<std::int64_t> stamps_ns(true_ns.size());
  for (std::size_t begin = 0; begin < true_ns.size();) {
    const auto size = static_cast<std::size_t>(least) + rng.below(static_cast<std::uint32_t>(most - least + 1));
    const std::size_t end = std::min(begin + size, true_ns.size());
    for (std::size_t i = begin; i < end; ++i) {
      stamps_ns[i] = true_ns[end - 1] + static_cast<std::int64_t>(i - begin) * kApart_ns;
    }
    begin = end;
  }
  return stamps_ns;
}

std::vector<std::int64_t> even_times(int scans, std::int64_t period_ns, std::int64_t first_ns) {
  std::vector<std::int64_t> times_ns;
  for (int i = 0; i < scans; ++i) {
    times_ns.push_back(first_ns + i * period_ns);
  }
  return times_ns;
}

StampCounts count_stamps(std::span<const std::int64_t> stamps_ns) {
  StampCounts counts;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    const double after_s = static_cast<double>(stamps_ns[i] - stamps_ns[i - 1]) * 1e-9;
    counts.out_of_order += after_s < 0.0 ? 1 : 0;
    counts.most_back_s = std::max(counts.most_back_s, -after_s);
    counts.within_10_ms += after_s >= 0.0 && after_s < 0.01 ? 1 : 0;
    counts.gaps_above_1_s += after_s > 1.0 ? 1 : 0;
  }
  return counts;
}

}  // namespace odoless::test
