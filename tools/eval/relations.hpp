#pragma once

#include <filesystem>
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

struct RelationsResult {
  PoseErrorStatistics errors;
  std::size_t used = 0;
  std::size_t missing = 0;  ///< relations of which the estimate lacks a pose
};

/// Compares each relation with the same motion of the estimate [kuemmerle2009metric, eq. 3 and 4, absolute errors].
/// No motion of the whole estimate changes the result.
[[nodiscard]] RelationsResult evaluate_relations(std::span<const Relation> relations,
                                                 std::span<const ReferencePose> estimate,
                                                 const Association& association);

}  // namespace odoless
