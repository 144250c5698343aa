// What damaged bytes may cost: at most one scan each, and never a wrong one.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "core/base/rng.hpp"
#include "tests/support/allocation_guard.hpp"
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

Stream scip_stream(LrfParams params = {}) { return Stream("urg-04lx", params, 450 * kMs); }

TEST(ScipRobustness, OneDamagedByteAnywhereCostsAtMostOneScan) {
  for (const LrfReading reading : {LrfReading::kRange, LrfReading::kShortRange}) {
    LrfParams params;
    params.reading = reading;
    const Stream stream = scip_stream(params);
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

TEST(ScipRobustness, AnySplitGivesTheSame) {
  const Stream stream = scip_stream();
  const std::vector<HeardScan> sent = heard_from(stream, stream.scans());
  Rng rng(5);
  for (int i = 0; i < 50; ++i) {
    test::Heard heard;
    const auto session = stream.ready_session(heard);
    std::string_view rest = stream.scans();
    while (!rest.empty()) {
      const std::size_t size = std::min<std::size_t>(rest.size(), i == 0 ? 1 : 1 + rng.below(i < 25 ? 100 : 5000));
      const std::string_view bytes = rest.substr(0, size);
      rest.remove_prefix(size);
      // By their place in the stream, so that the stamps make sense; they are not compared.
      const auto now_ns = 20 * test::kSecond + static_cast<std::int64_t>(stream.scans().size() - rest.size()) * 50'000;
      Stream::give(*session, bytes, now_ns, heard);
    }
    for (const LrfEvent& event : heard.events) {
      ADD_FAILURE() << describe(event.reason);
    }
    ASSERT_EQ(heard.scans.size(), sent.size()) << "split " << i;
    ASSERT_TRUE(are_among(heard.scans, sent));
  }
}

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
  test::Heard heard;
  const auto session = make_lrf_session({}, 2048);
  session->reset(0);
  Rng rng(13);
  const std::string_view alphabet = "MD0000108001000\n\n\n00P99bQTPPSCIP2.0;E:";
  for (std::int64_t now_ns = 0; now_ns < 20 * test::kSecond; now_ns += 5 * kMs) {
    std::string bytes(rng.below(2000), ' ');
    for (char& c : bytes) {
      c = rng.below(3) == 0 ? static_cast<char>(rng.below(256))
                            : alphabet[rng.below(static_cast<std::uint32_t>(alphabet.size()))];
    }
    EXPECT_LE(session->transmit().size(), 32U);
    Stream::give(*session, bytes, now_ns, heard);
    session->tick(now_ns, heard);
    ASSERT_GT(session->next_deadline_ns(), now_ns) << "or its owner would spin";
  }
  EXPECT_TRUE(heard.scans.empty());
}

/// Counts, and allocates nothing.
class Counter final : public LrfSink {
 public:
  void on_scan(const LrfScan&) override { ++scans; }
  void on_event(const LrfEvent&) override { ++events; }
  int scans = 0;
  int events = 0;
};

TEST(ScipRobustness, NothingIsAllocatedAfterConstruction) {
  if (!AllocationGuard::kWorks) {
    GTEST_SKIP() << "the sanitizer has malloc";
  }
  const Stream stream = scip_stream();
  std::vector<std::string> answers;
  test::Bench bench("urg-04lx");
  bench.on_the_way = [&](std::string& bytes) { answers.push_back(bytes); };
  bench.reset();
  bench.run(test::kSecond);
  const auto session = make_lrf_session({}, 1000);
  Counter counter;
  std::size_t next = 0;
  const AllocationGuard guard;
  session->reset(0);
  for (std::int64_t now_ns = 0; now_ns < 3 * test::kSecond; now_ns += kMs) {
    const bool asks = !session->transmit().empty();
    if (next < answers.size() && (asks || (session->ready() && now_ns % (100 * kMs) == 0))) {
      Stream::give(*session, answers[next++], now_ns, counter);
      Stream::give(*session, "garbage\n\n\n", now_ns, counter);
    }
    session->tick(now_ns, counter);
  }
  EXPECT_EQ(guard.calls(), 0);
  EXPECT_GT(counter.scans, 3);
  EXPECT_GT(counter.events, 3);
}

}  // namespace
}  // namespace odoless
