#pragma once

#include <filesystem>
#include <string>

#include "core/graph/pose_graph.hpp"
#include "tools/log/line_reader.hpp"

namespace odoless {

/// A pose graph as g2o and its kin read it: `VERTEX_SE2 id x y yaw` and `EDGE_SE2 from to dx dy dyaw` with the upper
/// triangle of the information matrix. Loop closures that were taken out are left out.
[[nodiscard]] std::string format_g2o(const PoseGraph& graph);

/// Reads such a file, plain, .gz or .xz. Vertices may have any numbers and any order; `FIX` is ignored, since the
/// vertex that comes first stays. Edges between vertices that do not follow each other are loop closures.
/// @throws DataError with file and line, NoInputError, IoError.
[[nodiscard]] PoseGraph read_g2o(const std::filesystem::path& path);
/// The same from lines that somebody else opened.
[[nodiscard]] PoseGraph read_g2o(LineReader& lines);

}  // namespace odoless
