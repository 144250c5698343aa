#pragma once

#include <cstdint>
#include <span>

#include "core/cloud/keyed_cloud.hpp"
#include "core/geometry/pose2.hpp"

namespace odoless {

/// Points of one key of the 3D map, for publication.
struct CloudPiece {
  std::int64_t stamp_ns = 0;  ///< of the key
  std::int32_t key = 0;
  std::int32_t edition = 0;  ///< grows when all of the key's points are published anew
  Pose2 map_T_key{};
  std::span<const CloudPoint> points{};  ///< in the key's frame
};

}  // namespace odoless
