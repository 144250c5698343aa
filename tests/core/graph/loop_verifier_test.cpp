// A match alone closes no loop; three that agree do; what says otherwise stays out.
#include "core/graph/loop_verifier.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace odoless {
namespace {

constexpr int kNodes = 40;

/// A row of submaps 4 m apart, whose odometry has drifted by `drift` from node 30 on, which is where node 0 is.
class LoopVerifierTest : public ::testing::Test {
 protected:
  LoopVerifierTest() {
    for (int i = 0; i < kNodes; ++i) {
      static_cast<void>(graph_.add_node({4.0 * (i % 30), 0.1 * i, 0.0}));
      if (i > 0) {
        graph_.add({.from = i - 1,
                    .to = i,
                    .from_T_to = graph_.between(i - 1, i),
                    .covariance = Eigen::Vector3d(0.01, 0.01, 1e-4).asDiagonal()});
      }
    }
  }

  /// The match of node 30 + i with node i that is true, moved by `off`.
  [[nodiscard]] LoopCandidate match(int i, const Pose2& off = {}) const {
    LoopCandidate out;
    out.reference = i;
    out.query = 30 + i;
    out.match = {.reference_T_query = off,
                 .covariance = Eigen::Vector3d(1e-3, 1e-3, 1e-4).asDiagonal(),
                 .score = 0.5,
                 .agreement = 0.95,
                 .coverage = 0.9,
                 .is_inside = true};
    return out;
  }

  PoseGraph graph_{kNodes, 2 * kNodes};
  LoopVerifier verifier_;
};

TEST_F(LoopVerifierTest, TwoThatAgreeAreNotEnough) {
  verifier_.add(match(1));
  EXPECT_TRUE(verifier_.verify(graph_, 31).empty());
  verifier_.add(match(2));
  EXPECT_TRUE(verifier_.verify(graph_, 32).empty());
}

TEST_F(LoopVerifierTest, ThreeOfThreeSubmapsThatAgreeAreAndAreGivenOnce) {
  for (const int i : {1, 2, 3}) {
    verifier_.add(match(i));
  }
  EXPECT_EQ(verifier_.verify(graph_, 33).size(), 3U);
  EXPECT_TRUE(verifier_.verify(graph_, 33).empty());
}

TEST_F(LoopVerifierTest, ThreeOfOneSubmapAreNot) {
  for (const int reference : {1, 2, 3}) {
    LoopCandidate candidate = match(1, {4.0 * (1 - reference), 0.0, 0.0});
    candidate.reference = reference;
    verifier_.add(candidate);
  }
  EXPECT_TRUE(verifier_.verify(graph_, 33).empty());
}

TEST_F(LoopVerifierTest, OneThatContradictsStaysOut) {
  verifier_.add(match(1));
  verifier_.add(match(2, {2.0, 0.5, 0.0}));
  verifier_.add(match(3));
  verifier_.add(match(4));
  const std::vector<LoopCandidate> verified = verifier_.verify(graph_, 34);
  ASSERT_EQ(verified.size(), 3U);
  EXPECT_TRUE(std::none_of(verified.begin(), verified.end(), [](const LoopCandidate& c) { return c.query == 32; }));
}

TEST_F(LoopVerifierTest, ThreeThatEachSaySomethingElseCloseNothing) {
  verifier_.add(match(1, {4.6, 0.0, 0.0}));
  verifier_.add(match(2, {-4.6, 0.0, 0.0}));
  verifier_.add(match(3));
  EXPECT_TRUE(verifier_.verify(graph_, 33).empty());
}

TEST_F(LoopVerifierTest, MatchesOfLongAgoAreForgotten) {
  verifier_.add(match(0));
  verifier_.add(match(1));
  EXPECT_TRUE(verifier_.verify(graph_, 31).empty());
  EXPECT_TRUE(verifier_.verify(graph_, 31 + LoopVerifier::kWindow + 1).empty());
  verifier_.add(match(9));
  EXPECT_TRUE(verifier_.verify(graph_, 39).empty());
}

TEST_F(LoopVerifierTest, WeakMatchesMustBeMore) {
  for (int i = 1; i <= 5; ++i) {
    LoopCandidate weak = match(i);
    weak.match.is_weak = true;
    verifier_.add(weak);
  }
  EXPECT_TRUE(verifier_.verify(graph_, 35).empty());
}

TEST_F(LoopVerifierTest, HoldsNoMoreThanItsPool) {
  for (int i = 0; i < 3 * LoopVerifier::kPool; ++i) {
    verifier_.add(match(1, {0.01 * i, 1.0, 0.0}));
  }
  for (const int i : {2, 3, 4}) {
    verifier_.add(match(i));
  }
  EXPECT_GE(verifier_.verify(graph_, 34).size(), 3U);
}

}  // namespace
}  // namespace odoless
