#pragma once

#include <string>

#include "firmware/daemon/control_command.hpp"
#include "firmware/daemon/machine.hpp"
#include "firmware/daemon/saver.hpp"
#include "firmware/health/status.hpp"

namespace odoless {

/// Carries out what somebody asks of a daemon. What takes long is begun, and a status says when it is done.
///
/// Thread: supervisor.
class Commands {
 public:
  /// @param ending  Whether the daemon ends; set where that is asked for.
  Commands(const DaemonOptions& options, Machine& machine, Saver& saver, bool& ending);

  /// @return  The answer, for a person or a program.
  [[nodiscard]] std::string obey(const ControlCommand& command);

 private:
  [[nodiscard]] std::string command_tilt(TiltCommand command);
  [[nodiscard]] std::string command_filter(const ControlCommand& command);
  [[nodiscard]] DaemonStatus status() const;
  [[nodiscard]] std::string tell_of_world(bool as_json) const;
  [[nodiscard]] std::string go_over(WorldUse use);
  [[nodiscard]] std::string begin_save(const ControlCommand& command);

  const DaemonOptions& options_;
  Machine& machine_;
  Saver& saver_;
  bool& ending_;
};

}  // namespace odoless
