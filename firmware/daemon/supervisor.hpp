#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/daemon/commands.hpp"
#include "firmware/daemon/control_server.hpp"
#include "firmware/daemon/machine.hpp"
#include "firmware/daemon/saver.hpp"
#include "firmware/daemon/signals.hpp"
#include "firmware/daemon/stage_watch.hpp"
#include "firmware/sources/line_keeper.hpp"

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

  /// Opens the socket for commands and tries to open the laser, before the machine starts. @return  Exit status where
  /// it is of no use to go on: a laser that is missing may still come, but not one that is used by another program.
  [[nodiscard]] int open();

  /// Starts the thread that saves. @return  0, or the errno for which there is none.
  [[nodiscard]] int start() { return saver_.start(); }

  /// @return  Exit status.
  [[nodiscard]] int run();

 private:
  [[nodiscard]] int open_control();
  [[nodiscard]] int open_laser();
  void wait();
  void handle_signals();
  void keep_laser_open();
  void keep_tilt_open();
  [[nodiscard]] bool watch();
  void tell(std::int64_t now_ns);
  void follow_gpio();
  void reload();
  [[nodiscard]] std::string answer(std::string_view line, const ControlPeer& peer);
  [[nodiscard]] bool save_last(bool is_complete);
  void wait_for_saver();
  [[nodiscard]] int end();
  [[noreturn]] void end_without_stages();

  static constexpr std::int64_t kRound_ns = 20'000'000;
  static constexpr std::int64_t kWatch_ns = 100'000'000;
  static constexpr unsigned kEnd_s = 30;  ///< in which stages end, or all is saved beside one that hangs
  static constexpr std::int64_t kStuck_ns = 120'000'000'000;  ///< a save that does not get on at the end is given up

  DaemonOptions& options_;
  Machine& machine_;
  ControlServer control_;
  LineKeeper keeper_;
  LineKeeper tilt_keeper_;
  Surroundings surroundings_;
  Saver saver_;
  bool ending_ = false;
  Commands commands_;
  SignalReader signals_;
  Errc laser_error_ = Errc::kOk;
  Errc tilt_error_ = Errc::kOk;
  std::int64_t next_watch_ns_ = 0;
  std::optional<StageWatch> stage_watch_;  ///< while the machine runs
  std::int64_t next_look_ns_ = 0;
  bool gpio_silent_ = false;
  std::int64_t power_cycles_ = 0;
};

}  // namespace odoless
