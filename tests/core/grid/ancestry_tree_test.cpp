#include "core/grid/ancestry_tree.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <set>
#include <vector>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

using Node = AncestryTree::Node;

/// Never forgets: each particle knows the names of all of its ancestors, and each name the marks that were made on it.
/// Marks stand for observations: what counts in the end is which marks each particle sees.
class NaiveFamily {
 public:
  explicit NaiveFamily(int particles) : seen_(static_cast<std::size_t>(particles)) {}

  void mark(std::size_t particle, int mark) { seen_[particle].insert(mark); }
  void resample(const std::vector<int>& copies) {
    std::vector<std::set<int>> next;
    for (std::size_t i = 0; i < copies.size(); ++i) {
      next.insert(next.end(), static_cast<std::size_t>(copies[i]), seen_[i]);
    }
    seen_ = next;
  }
  [[nodiscard]] const std::set<int>& seen(std::size_t particle) const { return seen_[particle]; }

 private:
  std::vector<std::set<int>> seen_;
};

/// Marks kept at the nodes of the tree under test, moved as its events say.
class MarkedTree {
 public:
  explicit MarkedTree(int particles) : tree(particles), marks_(static_cast<std::size_t>(tree.nodes_max())) {}

  void mark(int particle, int mark) { marks_[tree.leaf(particle)].insert(mark); }

  void retain(const std::vector<int>& copies) {
    tree.retain(copies);
    for (const Node node : tree.pruned()) {
      marks_[node].clear();
    }
    for (const auto& [gone, heir] : tree.merged()) {
      marks_[heir].merge(marks_[gone]);
      marks_[gone].clear();
    }
  }

  [[nodiscard]] std::set<int> seen(int particle) const {
    std::set<int> all;
    for (Node node = tree.leaf(particle); node != AncestryTree::kNone; node = tree.parent(node)) {
      all.insert(marks_[node].begin(), marks_[node].end());
    }
    return all;
  }

  [[nodiscard]] std::size_t marks() const {
    return std::accumulate(marks_.begin(), marks_.end(), std::size_t{0},
                           [](std::size_t sum, const std::set<int>& set) { return sum + set.size(); });
  }

  AncestryTree tree;

 private:
  std::vector<std::set<int>> marks_;
};

/// Copies per particle as a resampling of `particles` particles might give them; `keenness` kills more.
std::vector<int> random_copies(int particles, int wanted, int keenness, Rng& rng) {
  std::vector<int> copies(static_cast<std::size_t>(particles), 0);
  for (int i = 0; i < wanted; ++i) {
    auto chosen = rng.below(static_cast<std::uint32_t>(particles));
    for (int k = 0; k < keenness; ++k) {
      chosen = std::min(chosen, rng.below(static_cast<std::uint32_t>(particles)));
    }
    ++copies[chosen];
  }
  return copies;
}

/// Ancestors by parent links, compared with the answer by intervals.
void expect_intervals_agree_with_links(const AncestryTree& tree) {
  std::set<std::uint32_t> ranks;
  for (int below = 0; below < tree.particles(); ++below) {
    std::set<Node> ancestors;
    for (Node node = tree.leaf(below); node != AncestryTree::kNone; node = tree.parent(node)) {
      ancestors.insert(node);
    }
    for (int other = 0; other < tree.particles(); ++other) {
      for (Node node = tree.leaf(other); node != AncestryTree::kNone; node = tree.parent(node)) {
        EXPECT_EQ(tree.is_ancestor(node, tree.leaf(below)), ancestors.contains(node));
      }
    }
    EXPECT_LT(tree.rank(below), static_cast<std::uint32_t>(tree.particles()));
    ranks.insert(tree.rank(below));
  }
  EXPECT_EQ(ranks.size(), static_cast<std::size_t>(tree.particles()));
}

TEST(AncestryTree, LetsEveryParticleSeeWhatItsAncestorsSawHoweverTheyAreResampled) {
  for (const int particles : {1, 2, 3, 17}) {
    for (int keenness = 0; keenness < 4; ++keenness) {
      Rng rng(static_cast<std::uint64_t>(particles), static_cast<std::uint64_t>(keenness));
      MarkedTree marked(particles);
      NaiveFamily naive(1);
      int mark = 0;
      for (int round = 0; round < 60; ++round) {
        const std::vector<int> copies = random_copies(marked.tree.particles(), particles, keenness, rng);
        marked.retain(copies);
        for (std::size_t i = 0; i < copies.size(); ++i) {
          if (copies[i] > 0) {
            naive.mark(i, mark);
            marked.mark(static_cast<int>(i), mark);
            ++mark;
          }
        }
        marked.tree.branch(copies);
        naive.resample(copies);
        ASSERT_EQ(marked.tree.particles(), particles);
        ASSERT_LT(marked.tree.nodes(), 2 * particles);
        for (int i = 0; i < particles; ++i) {
          ASSERT_EQ(marked.seen(i), naive.seen(static_cast<std::size_t>(i))) << "round " << round;
        }
        expect_intervals_agree_with_links(marked.tree);
      }
    }
  }
}

TEST(AncestryTree, KeepsNothingThatNoParticleSees) {
  MarkedTree marked(4);
  marked.tree.branch(std::vector<int>{4});
  for (int i = 0; i < 4; ++i) {
    marked.mark(i, i);
  }
  marked.retain({0, 1, 0, 0});
  EXPECT_EQ(marked.marks(), 1U);
  EXPECT_EQ(marked.tree.nodes(), 1);
  EXPECT_EQ(marked.tree.leaf(0), AncestryTree::kNone);
  EXPECT_NE(marked.tree.leaf(1), AncestryTree::kNone);
}

TEST(AncestryTree, ReportsAChainOfMergesInOrder) {
  AncestryTree tree(3);
  tree.branch(std::vector<int>{2});  // root with two leaves
  const std::vector<int> second{1, 2};
  tree.retain(second);
  tree.branch(second);  // root: leaf, fork: leaf, leaf
  const Node survivor = tree.leaf(2);
  tree.retain(std::vector<int>{0, 0, 1});
  EXPECT_EQ(tree.pruned().size(), 2U);
  ASSERT_EQ(tree.merged().size(), 2U);
  EXPECT_EQ(tree.merged()[0].heir, tree.merged()[1].gone);
  EXPECT_EQ(tree.merged()[1].heir, survivor);
}

TEST(AncestryTree, StartsAnewAfterReset) {
  AncestryTree tree(5);
  tree.branch(std::vector<int>{5});
  tree.reset();
  EXPECT_EQ(tree.nodes(), 1);
  EXPECT_EQ(tree.particles(), 1);
  tree.branch(std::vector<int>{5});
  EXPECT_EQ(tree.particles(), 5);
}

TEST(AncestryTreeDeathTest, DiesWhenNoParticleSurvives) {
  AncestryTree tree(2);
  tree.branch(std::vector<int>{2});
  EXPECT_DEATH(tree.retain(std::vector<int>{0, 0}), "broken invariant");
}

}  // namespace
}  // namespace odoless
