// Whatever a world file holds, it makes a world with a path that can be driven, or a DataError.
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/base/check.hpp"
#include "tools/command/error.hpp"
#include "tools/sim/path.hpp"
#include "tools/sim/world_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const odoless::World world = odoless::parse_world({reinterpret_cast<const char*>(data), size}, "fuzz.world");
    const odoless::Path path(world.waypoints);
    const odoless::Pose2 end = path.at(path.duration_s());
    ODOLESS_CHECK(std::isfinite(path.duration_s()) && path.duration_s() > 0.0 && std::isfinite(path.length_m()));
    ODOLESS_CHECK(std::hypot(end.x_m - world.waypoints.back().position.x_m,
                             end.y_m - world.waypoints.back().position.y_m) < 1e-3);
  } catch (const odoless::DataError&) {
  }
  return 0;
}
