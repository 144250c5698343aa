#pragma once

#include "tools/experiment/scene.hpp"

namespace odoless {

/// Recorded logs that are public: the dissertation's own first one (Duke University, D-Wing), and in place of the
/// others, which are not public, building 079 in Freiburg, the ACES building in Austin, and key scans far apart in
/// Orebro.
[[nodiscard]] Scene dwing_scene();
[[nodiscard]] Scene fr079_scene();
[[nodiscard]] Scene aces_scene();
[[nodiscard]] Scene orebro_scene();

constexpr std::int64_t kQuickRecordedScans = 60;  ///< of a log, when little is to be done

}  // namespace odoless
