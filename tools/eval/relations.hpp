#pragma once

#include <filesystem>
#include <numbers>
#include <span>
#include <vector>

#include "tools/eval/pose_errors.hpp"
#include "tools/eval/stamp_lookup.hpp"

namespace odoless {

/// A motion that somebody has verified by hand: the pose at `to_s` in the frame of the pose at `from_s`.
struct Relation {
  double from_s = 0.0;
  double to_s = 0.0;
  Pose2 from_T_to;
};

/// Reads lines `t1 t2 x y z roll pitch yaw`, plain, .gz or .xz; height, roll and pitch are passed over.
/// @throws DataError, NoInputError, IoError.
[[nodiscard]] std::vector<Relation> read_relations(const std::filesystem::path& path);

/// Stamps up to here apart are of one drive past a place; what is farther apart was seen on another visit.
inline constexpr double kOneVisit_s = 15.0;
/// Off is a relation of one visit by more than this, ...
inline constexpr PoseError kOffOnOneVisit{0.3, 5.0 * std::numbers::pi / 180.0};
/// ... and one across a loop by more than this, whatever its rotation.
inline constexpr double kOffAcrossALoop_m = 0.5;

/// How many relations of a kind there are, and how many of them are off.
struct RelationsShare {
  std::size_t used = 0;
  std::size_t off = 0;
};

struct RelationsResult {
  PoseErrorStatistics errors;
  std::size_t used = 0;
  std::size_t missing = 0;      ///< relations of which the estimate lacks a pose
  RelationsShare one_visit;     ///< of the used ones, those up to kOneVisit_s apart
  RelationsShare across_loops;  ///< and the others
};

/// Compares each relation with the same motion of the estimate [kuemmerle2009metric, eq. 3 and 4, absolute errors].
/// No motion of the whole estimate changes the result.
[[nodiscard]] RelationsResult evaluate_relations(std::span<const Relation> relations,
                                                 std::span<const ReferencePose> estimate,
                                                 const Association& association);

}  // namespace odoless
