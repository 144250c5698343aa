#include "core/grid/ancestry_tree.hpp"

#include "core/base/check.hpp"

namespace odoless {

AncestryTree::AncestryTree(int particles_max) : particles_max_(static_cast<std::size_t>(particles_max)) {
  ODOLESS_CHECK(particles_max >= 1);
  const std::size_t nodes_max = 2 * particles_max_;
  nodes_.resize(nodes_max);
  free_.reserve(nodes_max);
  leaves_.resize(particles_max_, kNone);
  old_leaves_.resize(particles_max_, kNone);
  pruned_.reserve(nodes_max);
  merged_.reserve(nodes_max);
  reset();
}

void AncestryTree::reset() {
  free_.clear();
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    nodes_[i] = Links{};
    free_.push_back(static_cast<Node>(i));
  }
  pruned_.clear();
  merged_.clear();
  root_ = take_node();
  leaves_[0] = root_;
  leaf_count_ = 1;
  number_leaves();
}

void AncestryTree::retain(std::span<const int> copies) {
  ODOLESS_CHECK(copies.size() == leaf_count_);
  pruned_.clear();
  merged_.clear();
  for (std::size_t i = 0; i < leaf_count_; ++i) {
    if (copies[i] == 0) {
      prune(leaves_[i]);
      leaves_[i] = kNone;
    }
  }
  ODOLESS_CHECK(root_ != kNone);
  for (Node node = 0; node < nodes_.size(); ++node) {
    if (nodes_[node].alive && nodes_[node].children == 1) {
      merge_into_only_child(node);
    }
  }
  number_leaves();
}

void AncestryTree::branch(std::span<const int> copies) {
  ODOLESS_CHECK(copies.size() == leaf_count_);
  pruned_.clear();
  merged_.clear();
  old_leaves_.swap(leaves_);
  std::size_t count = 0;
  for (std::size_t i = 0; i < copies.size(); ++i) {
    const Node survivor = old_leaves_[i];
    ODOLESS_CHECK((survivor == kNone) == (copies[i] == 0));
    ODOLESS_CHECK(count + static_cast<std::size_t>(copies[i]) <= particles_max_);
    for (int copy = 0; copy < copies[i]; ++copy) {
      if (copies[i] > 1) {
        leaves_[count] = take_node();
        attach(leaves_[count], survivor);
      } else {
        leaves_[count] = survivor;
      }
      ++count;
    }
  }
  leaf_count_ = count;
  number_leaves();
}

AncestryTree::Node AncestryTree::take_node() {
  ODOLESS_CHECK(!free_.empty());
  const Node node = free_.back();
  free_.pop_back();
  nodes_[node] = Links{.alive = true};
  return node;
}

void AncestryTree::free_node(Node node) {
  nodes_[node].alive = false;
  free_.push_back(node);
}

void AncestryTree::attach(Node node, Node parent) {
  Links& links = nodes_[node];
  Links& above = nodes_[parent];
  links.parent = parent;
  links.next_sibling = above.first_child;
  links.previous_sibling = kNone;
  if (above.first_child != kNone) {
    nodes_[above.first_child].previous_sibling = node;
  }
  above.first_child = node;
  ++above.children;
}

void AncestryTree::detach(Node node) {
  const Links& links = nodes_[node];
  Links& above = nodes_[links.parent];
  if (links.previous_sibling == kNone) {
    above.first_child = links.next_sibling;
  } else {
    nodes_[links.previous_sibling].next_sibling = links.next_sibling;
  }
  if (links.next_sibling != kNone) {
    nodes_[links.next_sibling].previous_sibling = links.previous_sibling;
  }
  --above.children;
}

/// Removes a leaf, and every ancestor that this leaves childless.
void AncestryTree::prune(Node leaf) {
  for (Node node = leaf; node != kNone && nodes_[node].children == 0;) {
    const Node above = nodes_[node].parent;
    if (above == kNone) {
      root_ = kNone;
    } else {
      detach(node);
    }
    pruned_.push_back(node);
    free_node(node);
    node = above;
  }
}

void AncestryTree::merge_into_only_child(Node node) {
  const Node heir = nodes_[node].first_child;
  const Node above = nodes_[node].parent;
  if (above == kNone) {
    root_ = heir;
    nodes_[heir].parent = kNone;
  } else {
    detach(node);
    attach(heir, above);
  }
  merged_.push_back({node, heir});
  free_node(node);
}

void AncestryTree::number_leaves() {
  std::uint32_t rank = 0;
  for (Node node = root_; node != kNone;) {
    nodes_[node].ranks.first = rank;
    if (nodes_[node].children > 0) {
      node = nodes_[node].first_child;
    } else {
      nodes_[node].ranks.end = ++rank;
      node = next_in_tour(node);
    }
  }
}

/// The next node to enter after all below `node`; closes the intervals of the ancestors that are left on the way.
AncestryTree::Node AncestryTree::next_in_tour(Node node) {
  while (nodes_[node].next_sibling == kNone) {
    const Node above = nodes_[node].parent;
    if (above == kNone) {
      return kNone;
    }
    nodes_[above].ranks.end = nodes_[node].ranks.end;
    node = above;
  }
  return nodes_[node].next_sibling;
}

}  // namespace odoless
