// What damaged bytes may cost: at most one scan each, and never a wrong one.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "core/base/rng.hpp"
#include "tests/tools/emulate_stream.hpp"
#include "tests/tools/emulate_support.hpp"

namespace odoless {
namespace {

using test::are_among;
using test::heard_from;
using test::HeardScan;
using test::kMs;
using test::kMutations;
using test::Stream;

Stream scip_stream() { return Stream("urg-04lx", {}, 450 * kMs); }

// Of several echoes, a damaged byte can also become what separates them, or what did.
TEST(ScipRobustness, OneDamagedByteAnywhereCostsAtMostOneScan) {
  struct Asked {
    const char* model;
    LrfReading reading;
    std::int64_t duration_ns;
  };
  for (const Asked& asked : {Asked{"urg-04lx", LrfReading::kRange, 450 * kMs},
                             {"urg-04lx", LrfReading::kShortRange, 450 * kMs},
                             {"utm-30lx-ew", LrfReading::kLastEcho, 130 * kMs}}) {
    LrfParams params;
    params.reading = asked.reading;
    const Stream stream(asked.model, params, asked.duration_ns);
    const std::vector<HeardScan> sent = heard_from(stream, stream.scans());
    ASSERT_GE(sent.size(), 4U);
    ASSERT_EQ(sent.size(), stream.pieces());
    Rng rng(3);
    std::map<std::size_t, int> tries;
    const std::size_t scan_bytes = stream.scans().size() / stream.pieces();
    for (const auto& [name, mutate] : kMutations) {
      for (std::size_t at = scan_bytes; at < 2 * scan_bytes + 20; ++at) {
        const std::vector<HeardScan> heard = heard_from(stream, mutate(stream.scans(), at, rng));
        ASSERT_TRUE(are_among(heard, sent)) << name << " at " << at << ": a wrong scan";
        ASSERT_GE(heard.size() + 1, sent.size())
            << name << " at " << at << ", byte " << static_cast<int>(stream.scans()[at]);
        ++tries[sent.size() - heard.size()];
      }
    }
    EXPECT_GT(tries[1], tries[0]) << "most damage must be seen";
  }
}

TEST(ScipRobustness, AnySplitGivesTheSame) { test::expect_any_split_gives_the_same(scip_stream(), 50, 5000); }

// Row 7 of the promises: 5 % of the bytes wrong. The sums have 6 bits; what they let through is told by lengths and
// stamps.
TEST(ScipRobustness, ManyWrongBytesGiveNoWrongScan) {
  const Stream stream = scip_stream();
  const std::vector<HeardScan> sent = heard_from(stream, stream.scans());
  Rng rng(11);
  std::size_t wrong = 0;
  std::size_t right = 0;
  for (int i = 0; i < 1500; ++i) {
    std::string bytes = stream.scans();
    const double share = i % 2 == 0 ? 0.05 : 0.0005;
    std::for_each(bytes.begin(), bytes.end(),
                  [&](char& c) { c = rng.uniform() < share ? static_cast<char>(rng.below(256)) : c; });
    const std::vector<HeardScan> heard = heard_from(stream, bytes);
    (are_among(heard, sent) ? right : wrong) += heard.size();
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_GT(right, 500U) << "the test must let some scans through";
}

TEST(ScipRobustness, NoiseNeverEndsTheSession) {
  test::expect_noise_never_ends({}, "MD0000108001000\n\n\n00P99bQTPPSCIP2.0;E:", 32);
}

}  // namespace
}  // namespace odoless
