#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace odoless {

/// Who descends from whom among the particles of a filter [eliazar2003dpslam; method 6].
///
/// The leaves are the living particles. A resampling has two halves, so that a scan can be put into the survivors' maps
/// once, before they multiply: `retain` removes what no survivor descends from and merges every node with its only
/// child; `branch` gives each survivor that is copied more than once one child per copy. Both number the leaves by a
/// tour of the tree: the leaves below a node have the ranks of one interval, so that the question of who is whose
/// ancestor is two comparisons.
///
/// Promises:  fewer than 2 * particles_max nodes after every call; a fork has at least two children.
/// Thread:    owned by one thread.
/// Real time: no allocation after construction; `retain` and `branch` are linear in the particles.
class AncestryTree {
 public:
  using Node = std::uint32_t;
  static constexpr Node kNone = UINT32_MAX;

  /// Leaves below a node: ranks first .. end-1. Below a leaf: its own rank.
  struct Ranks {
    std::uint32_t first = 0;
    std::uint32_t end = 0;
  };

  /// `gone` had `heir` as its only child: what was gone's is heir's, where heir has nothing newer.
  struct Merge {
    Node gone;
    Node heir;
  };

  explicit AncestryTree(int particles_max);

  /// One particle, whose leaf is the root.
  void reset();

  /// Removes the particles i with copies[i] == 0 and all that only they descend from, then merges. Particles keep their
  /// indices until `branch`. At least one survives. `pruned` and `merged` say what happened, in that order.
  void retain(std::span<const int> copies);

  /// Makes copies[i] particles of each survivor i, numbered from 0 in the order of their parents; at most
  /// `particles_max` in all. `copies` are those that `retain` was given. Forgets what `pruned` and `merged` said.
  void branch(std::span<const int> copies);

  [[nodiscard]] int particles() const { return static_cast<int>(leaf_count_); }
  [[nodiscard]] int nodes() const { return static_cast<int>(nodes_.size() - free_.size()); }
  /// Upper bound of node numbers.
  [[nodiscard]] int nodes_max() const { return static_cast<int>(nodes_.size()); }

  /// Leaf of a particle; kNone for one that `retain` removed.
  [[nodiscard]] Node leaf(int particle) const { return leaves_[static_cast<std::size_t>(particle)]; }
  [[nodiscard]] Ranks ranks(Node node) const { return nodes_[node].ranks; }
  /// Rank of a living particle's leaf, below `particles_max`.
  [[nodiscard]] std::uint32_t rank(int particle) const { return nodes_[leaf(particle)].ranks.first; }
  /// Whether `above` is `below` itself or one of its ancestors.
  [[nodiscard]] bool is_ancestor(Node above, Node below) const {
    return nodes_[above].ranks.first <= nodes_[below].ranks.first && nodes_[below].ranks.end <= nodes_[above].ranks.end;
  }
  /// kNone for the root.
  [[nodiscard]] Node parent(Node node) const { return nodes_[node].parent; }

  /// Nodes that the last `retain` removed with everything that was theirs.
  [[nodiscard]] std::span<const Node> pruned() const { return pruned_; }
  /// Merges of the last `retain`, in the order in which they happened, after all prunings.
  [[nodiscard]] std::span<const Merge> merged() const { return merged_; }

 private:
  struct Links {
    Node parent = kNone;
    Node first_child = kNone;
    Node next_sibling = kNone;
    Node previous_sibling = kNone;
    std::uint32_t children = 0;
    bool alive = false;
    Ranks ranks{};
  };

  [[nodiscard]] Node take_node();
  void free_node(Node node);
  void attach(Node node, Node parent);
  void detach(Node node);
  void prune(Node leaf);
  void merge_into_only_child(Node node);
  void number_leaves();
  [[nodiscard]] Node next_in_tour(Node node);

  std::size_t particles_max_;
  std::size_t leaf_count_ = 0;
  Node root_ = kNone;
  std::vector<Links> nodes_;
  std::vector<Node> free_;
  std::vector<Node> leaves_;      ///< by particle
  std::vector<Node> old_leaves_;  ///< scratch of `branch`
  std::vector<Node> pruned_;
  std::vector<Merge> merged_;
};

}  // namespace odoless
