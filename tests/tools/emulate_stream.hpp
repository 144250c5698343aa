#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/rng.hpp"
#include "tests/tools/emulate_support.hpp"

namespace odoless::test {

/// The bytes of an emulated laser's stream, and sessions that have been brought up to it.
class Stream {
 public:
  Stream(std::string model, LrfParams params, std::int64_t duration_ns, WorldDrive drive = small_drive())
      : model_(std::move(model)), params_(params), drive_(std::move(drive)) {
    Bench bench(model_, {}, params, drive_);
    bench.reset();
    for (int i = 0; i < 500 && !bench.session().ready(); ++i) {
      bench.run(20 * kMs);
    }
    bench.on_the_way = [&](std::string& bytes) {
      scans_ += bytes;
      ++pieces_;
    };
    bench.run(duration_ns);
    period_ns_ = bench.session().geometry().period_ns;
  }

  [[nodiscard]] const std::string& scans() const { return scans_; }
  [[nodiscard]] std::size_t pieces() const { return pieces_; }
  [[nodiscard]] std::int64_t period_ns() const { return period_ns_; }

  /// A session that waits for the stream.
  [[nodiscard]] std::unique_ptr<LrfSession> ready_session(Heard& heard) const {
    WorldSource source(period_ns_of(model_), drive_);
    const auto device = make_emulated_lrf(model_, source, {}, 0);
    auto session = make_lrf_session(params_, 1081);
    session->reset(0);
    for (std::int64_t now_ns = 0; !session->ready() && now_ns < 10 * kSecond; now_ns += kMs) {
      device->set_line_baud(session->line_baud());
      const auto request = session->transmit();
      device->receive({reinterpret_cast<const char*>(request.data()), request.size()}, now_ns);
      for (const SentBytes& sent : device->take_output()) {
        give(*session, sent.bytes, now_ns, heard);
      }
      session->tick(now_ns, heard);
    }
    EXPECT_TRUE(session->ready());
    heard = {};
    return session;
  }

  static void give(LrfSession& session, std::string_view bytes, std::int64_t now_ns, LrfSink& sink) {
    session.receive(std::as_bytes(std::span(bytes.data(), bytes.size())), now_ns, sink);
  }

 private:
  std::string model_;
  LrfParams params_;
  WorldDrive drive_;
  std::string scans_;
  std::size_t pieces_ = 0;
  std::int64_t period_ns_ = 0;
};

/// All scans that are heard when these bytes come, `pieces` of the same size to a period.
inline std::vector<HeardScan> heard_from(const Stream& stream, const std::string& bytes, std::size_t piece_bytes) {
  Heard heard;
  const auto session = stream.ready_session(heard);
  std::int64_t now_ns = 20 * kSecond;
  for (std::size_t at = 0; at < bytes.size(); at += piece_bytes, now_ns += stream.period_ns()) {
    Stream::give(*session, std::string_view(bytes).substr(at, piece_bytes), now_ns, heard);
  }
  return heard.scans;
}

/// Where each piece is a scan.
inline std::vector<HeardScan> heard_from(const Stream& stream, const std::string& bytes) {
  return heard_from(stream, bytes, stream.scans().size() / stream.pieces());
}

/// Whether every scan of `heard` is, range for range, one of `sent`, in order.
inline bool are_among(const std::vector<HeardScan>& heard, const std::vector<HeardScan>& sent) {
  auto next = sent.begin();
  for (const HeardScan& scan : heard) {
    next = std::find_if(next, sent.end(), [&](const HeardScan& s) { return s.ranges_m == scan.ranges_m; });
    if (next == sent.end()) {
      return false;
    }
    ++next;
  }
  return true;
}

using Mutation = std::string (*)(std::string bytes, std::size_t at, Rng& rng);

inline const std::map<std::string, Mutation> kMutations{
    {"a flipped bit",
     [](std::string bytes, std::size_t at, Rng& rng) {
       bytes[at] = static_cast<char>(bytes[at] ^ (1 << rng.below(8)));
       return bytes;
     }},
    {"another byte",
     [](std::string bytes, std::size_t at, Rng& rng) {
       bytes[at] = static_cast<char>(bytes[at] + 1 + static_cast<int>(rng.below(255)));
       return bytes;
     }},
    {"a dropped byte", [](std::string bytes, std::size_t at, Rng&) { return bytes.erase(at, 1); }},
    {"a doubled byte", [](std::string bytes, std::size_t at, Rng&) { return bytes.insert(at, 1, bytes[at]); }},
    {"an inserted byte", [](std::string bytes, std::size_t at,
                            Rng& rng) { return bytes.insert(at, 1, static_cast<char>(rng.below(256))); }},
    {"an inserted line end", [](std::string bytes, std::size_t at, Rng&) { return bytes.insert(at, 1, '\n'); }},
};

/// One fault of an emulated laser, and what it may cost.
struct FaultCase {
  const char* fault;
  int scans_lost_max;
  int scans_lost_min = 0;

  friend void PrintTo(const FaultCase& fault_case, std::ostream* out) { *out << fault_case.fault; }
};

/// Its name as a part of a test's.
inline std::string fault_name(const ::testing::TestParamInfo<FaultCase>& tested) {
  std::string name = tested.param.fault;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

/// The stream in pieces of chance sizes, the first time byte by byte: the same scans, and nothing is told.
inline void expect_any_split_gives_the_same(const Stream& stream, int splits, std::uint32_t piece_max_bytes) {
  const std::vector<HeardScan> sent = heard_from(stream, stream.scans());
  ASSERT_FALSE(sent.empty());
  // By their place in the stream, so that the stamps make sense; they are not compared.
  const std::int64_t byte_ns =
      stream.period_ns() * static_cast<std::int64_t>(sent.size()) / static_cast<std::int64_t>(stream.scans().size());
  Rng rng(5);
  for (int i = 0; i < splits; ++i) {
    Heard heard;
    const auto session = stream.ready_session(heard);
    std::int64_t now_ns = 20 * kSecond;
    for (std::string_view rest = stream.scans(); !rest.empty();) {
      const std::size_t size = i == 0 ? 1 : 1 + rng.below(i < splits / 2 ? 50 : piece_max_bytes);
      const std::string_view piece = rest.substr(0, size);
      now_ns += static_cast<std::int64_t>(piece.size()) * byte_ns;
      Stream::give(*session, piece, now_ns, heard);
      rest.remove_prefix(piece.size());
    }
    for (const LrfEvent& event : heard.events) {
      ADD_FAILURE() << describe(event.reason);
    }
    ASSERT_EQ(heard.scans.size(), sent.size()) << "split " << i;
    ASSERT_TRUE(are_among(heard.scans, sent));
  }
}

/// Noise, two thirds of it of what the protocol is made of: no scan, and no busy loop.
inline void expect_noise_never_ends(const LrfParams& params, std::string_view alphabet, std::size_t request_max_bytes) {
  Heard heard;
  const auto session = make_lrf_session(params, 2048);
  session->reset(0);
  Rng rng(13);
  for (std::int64_t now_ns = 0; now_ns < 20 * kSecond; now_ns += 5 * kMs) {
    std::string bytes(rng.below(2000), ' ');
    for (char& c : bytes) {
      c = rng.below(3) == 0 ? static_cast<char>(rng.below(256))
                            : alphabet[rng.below(static_cast<std::uint32_t>(alphabet.size()))];
    }
    EXPECT_LE(session->transmit().size(), request_max_bytes);
    Stream::give(*session, bytes, now_ns, heard);
    session->tick(now_ns, heard);
    ASSERT_GT(session->next_deadline_ns(), now_ns) << "or its owner would spin";
  }
  EXPECT_TRUE(heard.scans.empty());
}

}  // namespace odoless::test
