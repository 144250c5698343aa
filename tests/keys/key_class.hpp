#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/daemon/daemon_params.hpp"

namespace odoless::test {

/// A use of the program, and all that its user sees of it.
struct Scene {
  std::string name;
  /// What the configuration says besides the key in question: enough for the key to matter, little enough to be fast.
  std::vector<std::string> tomls;  ///< each over those before
  /// What there is to be seen, as text; the same configuration gives the same text.
  std::function<std::string(const DaemonParams&)> look;
};

/// Keys that act in the same place, and the scenes in which a user sees it.
struct KeyClass {
  std::string name;
  std::vector<std::string> prefixes;           ///< of the keys; of two that fit, the longer one counts
  std::function<std::vector<Scene>()> scenes;  ///< tried one after the other
  /// Why this machine cannot show them; empty: it can.
  std::function<std::string()> lack = [] { return std::string(); };
};

/// Why threads have no priority of their own here; empty: they can.
[[nodiscard]] std::string lack_of_real_time();

/// Odometry from scan matching, the particle filter and the pose graph, by what a replay and `odoless match` write.
[[nodiscard]] std::vector<KeyClass> slam_classes();
/// The 3D map, by what `odoless cloud` writes.
[[nodiscard]] KeyClass mapping_class();
/// The laser, by what it is sent, and what comes of what it sends.
[[nodiscard]] KeyClass laser_class();
/// The tilt servo, by what it is sent, how it moves and what comes of that.
[[nodiscard]] KeyClass tilt_class();
/// Threads, queues, budgets, and the daemon as a whole.
[[nodiscard]] std::vector<KeyClass> thread_classes();
/// LCM, the recorder and health, by what is published.
[[nodiscard]] std::vector<KeyClass> publisher_classes();
/// GPIO, by what is on the lines.
[[nodiscard]] KeyClass gpio_class();
/// The page, by what a browser is answered.
[[nodiscard]] KeyClass web_class();
/// The world file, by what is in it and when.
[[nodiscard]] KeyClass world_class();

[[nodiscard]] std::vector<KeyClass> key_classes();

/// The classes whose longest fitting prefix is the longest of all: one, if all is well.
[[nodiscard]] std::vector<const KeyClass*> classes_of(std::string_view key, const std::vector<KeyClass>& classes);

}  // namespace odoless::test
