#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "core/geometry/pose2.hpp"
#include "drivers/tilt/tilt_params.hpp"

namespace odoless {

/// What somebody may ask of the daemon.
struct ControlCommand {
  enum class Kind {
    kStatus,
    kStatusJson,
    kWorld,
    kWorldJson,
    kSave,
    kReset,
    kPose,
    kPause,
    kResume,
    kLocalise,
    kMap,
    kTilt,
    kStop
  };
  Kind kind = Kind::kStatus;
  Pose2 map_T_robot{};                    ///< of kPose: finite, within `kPoseMax_m`
  TiltCommand tilt = TiltCommand::kStop;  ///< of kTilt
  std::string folder{};                   ///< of kSave: an absolute path; empty: the run's own
  bool is_forced = false;                 ///< of kSave: results in that folder are replaced

  [[nodiscard]] bool only_asks() const { return kind <= Kind::kWorldJson; }
};

/// Farthest from the map's origin, along x and y, that a robot can be put.
inline constexpr double kPoseMax_m = 10'000.0;

/// All commands, for a person.
inline constexpr const char* kControlCommands =
    "status [json], world [json], save [[--force] /PATH], reset, pose X_M Y_M YAW_DEG, pause, resume, localise, map, "
    "tilt level|sweep|stop, stop";

/// Reads a command, word by word, from whoever may write to the socket: nothing of it is trusted.
/// @return  The command, or why it is refused: what is wrong and what would be right.
[[nodiscard]] std::variant<ControlCommand, std::string> parse_control_command(std::string_view line);

}  // namespace odoless
