#pragma once

#include <span>
#include <vector>

#include "core/graph/pose_graph.hpp"
#include "core/graph/submap_matcher.hpp"

namespace odoless {

/// A match that may close a loop.
struct LoopCandidate {
  int reference = 0;
  int query = 0;
  SubmapMatch match;
};

/// Holds matches back until others say the same. Where corridors look alike one match may be wrong however good it is;
/// three from three submaps that agree with each other, through the odometry between them, are not
/// [olson2009recognizing; mangelson2018pcm; method 9].
///
/// Thread: owned by one thread. Memory is bounded by kPool. Not for real-time threads.
class LoopVerifier {
 public:
  static constexpr int kPool = 96;
  static constexpr int kWindow = 12;  ///< submaps that a match is held back for

  void add(const LoopCandidate& candidate);
  /// Submaps have other numbers. @param now  Of each that there was; negative: it is no more.
  void renumber(std::span<const int> now);
  /// Forgets what is older than kWindow submaps before `newest`, and gives the largest set of matches that agree, if it
  /// is enough; these are then no longer held back.
  [[nodiscard]] std::vector<LoopCandidate> verify(const PoseGraph& graph, int newest);

 private:
  struct Set {
    std::vector<std::size_t> members;
    double value = 0.0;
    int queries = 0;
  };

  /// Which pairs agree: row by row.
  [[nodiscard]] std::vector<std::vector<bool>> compare(const PoseGraph& graph) const;
  [[nodiscard]] Set grow(std::size_t first, const std::vector<std::vector<bool>>& agrees) const;
  void evaluate(Set& set) const;

  std::vector<LoopCandidate> pool_;
};

}  // namespace odoless
