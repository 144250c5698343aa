#include "core/grid/ancestry_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/check.hpp"

namespace odoless {
namespace {

std::uint32_t tiles_over(double extent_m, double resolution_m) {
  const double tile_m = resolution_m * AncestryGrid::kTileSide_cells;
  return static_cast<std::uint32_t>(std::max(1.0, std::ceil(extent_m / tile_m - 1e-9)));
}

int cells_of(std::uint32_t tiles) { return static_cast<int>(tiles) * AncestryGrid::kTileSide_cells; }

/// Column or row of tiles modulo those of the window.
std::uint32_t place(int tile, std::uint32_t tiles) {
  const int rest = tile % static_cast<int>(tiles);
  return static_cast<std::uint32_t>(rest < 0 ? rest + static_cast<int>(tiles) : rest);
}

}  // namespace

AncestryGrid::AncestryGrid(const AncestryGridParams& params, int particles_max)
    : tile_columns_(tiles_over(params.width_m, params.resolution_m)),
      tile_rows_(tiles_over(params.height_m, params.resolution_m)),
      geometry_{.resolution_m = params.resolution_m, .columns = cells_of(tile_columns_), .rows = cells_of(tile_rows_)},
      tree_(particles_max),
      leaves_max_(static_cast<std::size_t>(particles_max)),
      versions_max_(static_cast<std::size_t>(params.tiles_max) + kFirstVersion) {
  ODOLESS_CHECK(parameters_in_range(params));
  const std::size_t tiles = std::size_t{tile_columns_} * tile_rows_;
  tiles_.reserve(versions_max_);
  tiles_.resize(kFirstVersion);
  versions_.reserve(versions_max_);
  versions_.resize(kFirstVersion);
  free_.reserve(versions_max_);
  first_of_tile_.resize(tiles);
  owned_.resize(static_cast<std::size_t>(tree_.nodes_max()));
  owner_of_node_.resize(owned_.size());
  node_of_owner_.resize(owned_.size());
  answers_of_tile_.resize(tiles);
  answered_.reserve(tiles);
  answers_.reserve(tiles * leaves_max_);
  written_m_.resize(tiles);
  reset();
}

void AncestryGrid::reset() {
  tree_.reset();
  std::fill(first_of_tile_.begin(), first_of_tile_.end(), kNone);
  std::fill(owned_.begin(), owned_.end(), OwnedTiles{});
  std::iota(owner_of_node_.begin(), owner_of_node_.end(), Owner{0});
  std::iota(node_of_owner_.begin(), node_of_owner_.end(), Node{0});
  free_.clear();
  for (auto version = static_cast<Version>(versions_.size()); version-- > kFirstVersion;) {
    free_.push_back(version);
  }
  counters_ = {};
  geometry_.first_column = geometry_.first_row = 0;
  travel_m_ = 0.0;
  next_to_forget_ = 0;
  forget_answers();
}

void AncestryGrid::centre_on(const GridCell& cell) {
  const auto first = [](int middle, int cells) { return (middle - cells / 2) >> kTileBits << kTileBits; };
  geometry_.first_column = first(cell.column(), geometry_.columns);
  geometry_.first_row = first(cell.row(), geometry_.rows);
}

void AncestryGrid::follow(const GridCell& cell) {
  const auto direction = [](int at, int first, int cells) {
    return at < first + cells / 4 ? -1 : at >= first + cells - cells / 4 ? 1 : 0;
  };
  if (const int step = direction(cell.column(), geometry_.first_column, geometry_.columns); step != 0) {
    step_columns(step);
  }
  if (const int step = direction(cell.row(), geometry_.first_row, geometry_.rows); step != 0) {
    step_rows(step);
  }
}

// The column that leaves on one side and the one that comes on the other have the same place.
void AncestryGrid::step_columns(int direction) {
  const int leaving = geometry_.first_column + (direction > 0 ? 0 : geometry_.columns - 1);
  for (int row = 0; row < geometry_.rows; row += kTileSide_cells) {
    forget(tile_of({leaving, geometry_.first_row + row}));
  }
  geometry_.first_column += direction * kTileSide_cells;
}

void AncestryGrid::step_rows(int direction) {
  const int leaving = geometry_.first_row + (direction > 0 ? 0 : geometry_.rows - 1);
  for (int column = 0; column < geometry_.columns; column += kTileSide_cells) {
    forget(tile_of({geometry_.first_column + column, leaving}));
  }
  geometry_.first_row += direction * kTileSide_cells;
}

void AncestryGrid::forget_before(double travel_m, int tiles) {
  for (int i = 0; i < tiles; ++i) {
    if (first_of_tile_[next_to_forget_] != kNone && static_cast<double>(written_m_[next_to_forget_]) < travel_m) {
      forget(next_to_forget_);
    }
    next_to_forget_ = next_to_forget_ + 1 < first_of_tile_.size() ? next_to_forget_ + 1 : 0;
  }
}

void AncestryGrid::forget(std::uint32_t tile) {
  while (first_of_tile_[tile] != kNone) {
    remove(first_of_tile_[tile]);
  }
  if (answers_of_tile_[tile] != 0) {
    std::fill_n(&answers_[static_cast<std::size_t>(answers_of_tile_[tile] - 1) * leaves_max_], leaves_max_, kBlank);
  }
}

void AncestryGrid::retain(std::span<const int> copies) {
  tree_.retain(copies);
  for (const Node node : tree_.pruned()) {
    const OwnedTiles& tiles = owned_[owner_of_node_[node]];
    while (tiles.first != kNone) {
      remove(tiles.first);
    }
  }
  for (const auto& [gone, heir] : tree_.merged()) {
    merge(gone, heir);
  }
  forget_answers();
}

void AncestryGrid::branch(std::span<const int> copies) {
  tree_.branch(copies);
  forget_answers();
}

/// Ancestors paint first and descendants over them: the list, read from its end, has them in this order.
void AncestryGrid::answer(std::uint32_t tile) {
  answered_.push_back(tile);
  answers_of_tile_[tile] = static_cast<std::uint32_t>(answered_.size());
  answers_.resize(std::max(answers_.size(), answered_.size() * leaves_max_));
  Version* const row = &answers_[(answered_.size() - 1) * leaves_max_];
  std::fill_n(row, leaves_max_, kBlank);
  Version last = first_of_tile_[tile];
  while (last != kNone && versions_[last].next_in_tile != kNone) {
    last = versions_[last].next_in_tile;
  }
  for (Version version = last; version != kNone; version = versions_[version].previous_in_tile) {
    const AncestryTree::Ranks ranks = tree_.ranks(node_of_owner_[versions_[version].owner]);
    std::fill(row + ranks.first, row + ranks.end, version);
  }
}

void AncestryGrid::forget_answers() {
  for (const std::uint32_t tile : answered_) {
    answers_of_tile_[tile] = 0;
  }
  answered_.clear();
}

/// The leaf's own version of a tile, made at its first write; kWaste if the pool is full.
AncestryGrid::Version AncestryGrid::own_version(std::uint32_t tile, Node leaf, std::uint32_t rank) {
  Version& version = seen(tile, rank);
  written_m_[tile] = static_cast<float>(travel_m_);
  const Owner owner = owner_of_node_[leaf];
  if (version != kBlank && versions_[version].owner == owner) {
    return version;
  }
  if (free_.empty() && versions_.size() == versions_max_) {
    ++counters_.refused_tiles;
    return kWaste;
  }
  const Version own = unused_version();
  tiles_[own] = tiles_[version];
  link_to_tile(own, tile);
  link_to_owner(own, owner);
  version = own;
  return own;
}

/// In front of the tile's list: a leaf is nobody's ancestor.
AncestryGrid::Version AncestryGrid::unused_version() {
  if (free_.empty()) {
    tiles_.emplace_back();
    versions_.emplace_back();
    return static_cast<Version>(versions_.size() - 1);
  }
  const Version version = free_.back();
  free_.pop_back();
  return version;
}

void AncestryGrid::link_to_tile(Version version, std::uint32_t tile) {
  Entry& entry = versions_[version];
  entry.tile = tile;
  entry.previous_in_tile = kNone;
  entry.next_in_tile = first_of_tile_[tile];
  if (entry.next_in_tile != kNone) {
    versions_[entry.next_in_tile].previous_in_tile = version;
  }
  first_of_tile_[tile] = version;
}

void AncestryGrid::unlink_from_tile(Version version) {
  const Entry& entry = versions_[version];
  if (entry.previous_in_tile == kNone) {
    first_of_tile_[entry.tile] = entry.next_in_tile;
  } else {
    versions_[entry.previous_in_tile].next_in_tile = entry.next_in_tile;
  }
  if (entry.next_in_tile != kNone) {
    versions_[entry.next_in_tile].previous_in_tile = entry.previous_in_tile;
  }
}

void AncestryGrid::link_to_owner(Version version, Owner owner) {
  Entry& entry = versions_[version];
  OwnedTiles& tiles = owned_[owner];
  entry.owner = owner;
  entry.previous_of_owner = kNone;
  entry.next_of_owner = tiles.first;
  if (tiles.first != kNone) {
    versions_[tiles.first].previous_of_owner = version;
  }
  tiles.first = version;
  ++tiles.count;
}

void AncestryGrid::unlink_from_owner(Version version) {
  const Entry& entry = versions_[version];
  OwnedTiles& tiles = owned_[entry.owner];
  if (entry.previous_of_owner == kNone) {
    tiles.first = entry.next_of_owner;
  } else {
    versions_[entry.previous_of_owner].next_of_owner = entry.next_of_owner;
  }
  if (entry.next_of_owner != kNone) {
    versions_[entry.next_of_owner].previous_of_owner = entry.previous_of_owner;
  }
  --tiles.count;
}

void AncestryGrid::remove(Version version) {
  unlink_from_owner(version);
  unlink_from_tile(version);
  free_.push_back(version);
}

/// The heir gets the union of both nodes' versions, its own where there are two; the shorter list is moved.
void AncestryGrid::merge(Node gone, Node heir) {
  const bool heir_moves = owned_[owner_of_node_[gone]].count > owned_[owner_of_node_[heir]].count;
  if (heir_moves) {
    std::swap(owner_of_node_[gone], owner_of_node_[heir]);
    std::swap(node_of_owner_[owner_of_node_[gone]], node_of_owner_[owner_of_node_[heir]]);
  }
  move_versions(owner_of_node_[gone], owner_of_node_[heir], heir_moves);
}

void AncestryGrid::move_versions(Owner from, Owner to, bool from_is_newer) {
  while (owned_[from].first != kNone) {
    const Version version = owned_[from].first;
    const Version twin = find_beside(version, to, from_is_newer);
    if (twin != kNone && !from_is_newer) {
      remove(version);
      continue;
    }
    if (twin != kNone) {
      remove(twin);
    }
    unlink_from_owner(version);
    link_to_owner(version, to);
  }
}

/// The owner's version of the same tile; an ancestor's stands below in the tile's list, a descendant's above.
AncestryGrid::Version AncestryGrid::find_beside(Version version, Owner owner, bool below) const {
  Version other = version;
  do {
    other = below ? versions_[other].next_in_tile : versions_[other].previous_in_tile;
  } while (other != kNone && versions_[other].owner != owner);
  return other;
}

/// Number of the place of the tile that holds the cell, or kOutside.
std::uint32_t AncestryGrid::tile_of(const GridCell& cell) const {
  const int column = cell.column() - geometry_.first_column;
  const int row = cell.row() - geometry_.first_row;
  if (column < 0 || row < 0 || column >= geometry_.columns || row >= geometry_.rows) {
    return kOutside;
  }
  return place(cell.row() >> kTileBits, tile_rows_) * tile_columns_ + place(cell.column() >> kTileBits, tile_columns_);
}

GridCell AncestryGrid::corner_of(std::uint32_t tile) const {
  const auto cell = [](std::uint32_t at, std::uint32_t tiles, int first_cell) {
    const std::uint32_t first = place(first_cell >> kTileBits, tiles);
    return first_cell + static_cast<int>(at >= first ? at - first : at + tiles - first) * kTileSide_cells;
  };
  return {cell(tile % tile_columns_, tile_columns_, geometry_.first_column),
          cell(tile / tile_columns_, tile_rows_, geometry_.first_row)};
}

void AncestryGrid::View::enter(const GridCell& cell) {
  tile_ = cell.tile<kTileBits>();
  const std::uint32_t tile = grid_.tile_of(cell);
  cells_ = grid_.tiles_[tile == kOutside ? kBlank : grid_.seen(tile, rank_)].cells.data();
}

void AncestryGrid::Writer::enter(const GridCell& cell) {
  tile_ = cell.tile<kTileBits>();
  const std::uint32_t tile = grid_.tile_of(cell);
  grid_.counters_.outside_tiles += tile == kOutside ? 1 : 0;
  cells_ = grid_.tiles_[tile == kOutside ? kWaste : grid_.own_version(tile, leaf_, rank_)].cells.data();
}

}  // namespace odoless
