#include "core/scan/point_set.hpp"

#include <limits>

#include "core/math/elementary.hpp"

namespace odoless {

void append_thinned(const ScanFrame& scan, const Pose2& target_T_scan, double spacing_m, PointSet& out) {
  const auto [s, c] = math::sincos(target_T_scan.yaw_rad);
  constexpr double kFar_m = std::numeric_limits<double>::max();
  const double spacing_m2 = spacing_m * spacing_m;
  Point2 last{kFar_m, kFar_m};
  for (int i = 0; i < scan.size(); ++i) {
    if (!scan.is_return(i)) {
      continue;
    }
    const Point2 p = scan.point(i);
    const double dx = p.x_m - last.x_m;
    const double dy = p.y_m - last.y_m;
    if (dx * dx + dy * dy < spacing_m2) {
      continue;
    }
    last = p;
    out.push_back({target_T_scan.x_m + c * p.x_m - s * p.y_m, target_T_scan.y_m + s * p.x_m + c * p.y_m});
  }
}

}  // namespace odoless
