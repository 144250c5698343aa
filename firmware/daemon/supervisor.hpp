#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "firmware/daemon/control_server.hpp"
#include "firmware/daemon/machine.hpp"

namespace odoless {

/// Runs a machine: opens the laser again and again, obeys signals and commands, feeds the watchdog while every stage
/// answers, and ends the run.
///
/// Thread: the program's first.
class Supervisor {
 public:
  Supervisor(DaemonOptions& options, Machine& machine, std::uint32_t standing_reasons);

  /// Something that holds for the whole run.
  void add_standing_reason(std::uint32_t reason) { surroundings_.standing_reasons |= reason; }

  /// Tries to open the laser, before the machine starts. @return  Exit status where it is of no use to go on: one that
  /// is missing may still come, but not one that is used by another program.
  [[nodiscard]] int open_laser();

  /// @return  Exit status.
  [[nodiscard]] int run();

 private:
  void open_control();
  void wait();
  void handle_signal();
  void keep_laser_open();
  void keep_tilt_open();
  [[nodiscard]] std::string command_tilt(std::string_view argument);
  [[nodiscard]] bool watch();
  void follow_gpio();
  void reload();
  [[nodiscard]] std::string obey(std::string_view command);
  [[nodiscard]] std::string command_filter(std::string_view word, std::string_view arguments);
  [[nodiscard]] std::string status_text();
  [[nodiscard]] std::string save();
  [[nodiscard]] int end();

  static constexpr std::int64_t kRound_ns = 20'000'000;
  static constexpr std::int64_t kWatch_ns = 100'000'000;
  static constexpr std::int64_t kDrain_ns = 700'000'000;

  DaemonOptions& options_;
  Machine& machine_;
  ControlServer control_;
  LineKeeper keeper_;
  LineKeeper tilt_keeper_;
  Surroundings surroundings_;
  FileDescriptor signals_;
  bool ending_ = false;
  Errc laser_error_ = Errc::kOk;
  Errc tilt_error_ = Errc::kOk;
  std::int64_t next_watch_ns_ = 0;
  std::int64_t silent_ns_ = 0;
  bool gpio_silent_ = false;
  std::int64_t power_cycles_ = 0;
};

}  // namespace odoless
