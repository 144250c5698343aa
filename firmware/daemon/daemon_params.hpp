#pragma once

#include <optional>
#include <string>

#include "config/robot_params.hpp"
#include "core/cloud/mapping_params.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/tilt/tilt_params.hpp"
#include "firmware/gpio/gpio_params.hpp"
#include "firmware/health/health_monitor.hpp"
#include "firmware/lcm/lcm_params.hpp"
#include "firmware/lcm/log_writer_params.hpp"
#include "firmware/pipeline/pipeline_params.hpp"
#include "firmware/web/web_params.hpp"
#include "firmware/world/world_params.hpp"

namespace odoless {

struct ControlParams {
  std::string socket = "/run/odoless/control";

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.text("socket", self.socket,
               "Path of the socket that `odoless ctl` talks to, for its owner and group (mode 0660); empty: none. The "
               "built-in one is in $XDG_RUNTIME_DIR/odoless for a user who may not write to /run/odoless.");
  }
};

/// All that a robot's configuration file can say: the SLAM, and the machine around it.
struct DaemonParams {
  RobotParams robot;
  LrfParams lrf;
  GpioParams gpio;
  TiltParams tilt;
  MappingParams mapping;
  LcmParams lcm;
  PipelineParams pipeline;
  LogWriterParams recorder;
  HealthParams health;
  ControlParams control;
  WebParams web;
  WorldParams world;

  /// The 3D map, which takes a tilting laser; none where there is no tilt servo, or it is switched off.
  [[nodiscard]] std::optional<MappingParams> mapping_in_use() const {
    return tilt.driver != TiltDriver::kNone && mapping.enabled ? std::optional(mapping) : std::nullopt;
  }

  /// Values that are in range and don't go together, for a person: keys, what is wrong, what would be right. Empty:
  /// none.
  [[nodiscard]] std::string contradiction() const;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("lrf", self.lrf, "The laser range finder.");
    visit.group("gpio", self.gpio,
                "Lines of the machine: emergency stop, sync pulse, the laser's power, status light.");
    visit.group("tilt", self.tilt, "The servo that tilts the laser.");
    visit.group("mapping", self.mapping, "3D mapping with a laser that a servo tilts.");
    visit.group("lcm", self.lcm, "What is published.");
    visit.group("pipeline", self.pipeline, "Threads, queues and time budgets of the daemon.");
    visit.group("recorder", self.recorder, "The log of all messages.");
    visit.group("health", self.health, "Thresholds of the health report.");
    visit.group("control", self.control, "Commands to the daemon.");
    visit.group("web", self.web, "The page that shows in a browser what the daemon does.");
    visit.group("world", self.world, "World file, in which the map is kept.");
    RobotParams::describe(self.robot, visit);
  }
};

}  // namespace odoless
