#include "firmware/daemon/supervisor.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sysexits.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>
#include <variant>

#include "drivers/io/device_advice.hpp"
#include "drivers/io/device_line.hpp"
#include "drivers/lrf/make_lrf_session.hpp"
#include "drivers/tilt/tilt_line.hpp"
#include "firmware/daemon/crash_report.hpp"
#include "firmware/daemon/log.hpp"
#include "firmware/daemon/service_manager.hpp"
#include "firmware/health/health_text.hpp"

namespace odoless {
namespace {

LineKeeper::Open laser_opener(const DaemonParams& params) {
  return [line = std::make_shared<DeviceLine>(params.lrf.device, params.lrf.baud), &params] {
    Result<FileDescriptor> opened = line->open(params.pipeline.sensor_priority);
    if (opened.ok()) {
      set_up_lrf_line(params.lrf, opened.value().get());
    }
    return opened;
  };
}

}  // namespace

Supervisor::Supervisor(DaemonOptions& options, Machine& machine, std::uint32_t standing_reasons)
    : options_(options),
      machine_(machine),
      keeper_(laser_opener(options.params), machine.line(), machine.pipeline().sensor.wake),
      tilt_keeper_([&options] { return open_tilt_line(options.params.tilt); }, machine.tilt_line(),
                   machine.pipeline().sensor.wake),
      saver_(options, machine),
      commands_(options, machine, saver_, ending_) {
  surroundings_.standing_reasons = standing_reasons;
}

int Supervisor::run() {
  stage_watch_.emplace(machine_.watched_stages());
  notify_service_manager("READY=1");
  while (!ending_ && !machine_.has_ended()) {
    if (!watch()) {  // before anybody is answered: an emergency stop is told of from the first status on
      end_without_stages();
    }
    wait();
    keep_laser_open();
    keep_tilt_open();
  }
  return end();
}

int Supervisor::open() {
  const int status = open_control();
  return status != EX_OK ? status : open_laser();
}

int Supervisor::open_laser() {
  if (!machine_.reads_laser()) {
    if (options_.params.gpio.is_used()) {
      log_line(EventPriority::kNotice,
               "[gpio] is not served here, the stop line neither: that is for the daemon that reads the laser");
    }
    return EX_OK;
  }
  laser_error_ = keeper_.tick(machine_.clock().now_ns());
  if (laser_error_ == Errc::kOk) {
    return EX_OK;
  }
  const std::string& device = options_.params.lrf.device;
  if (laser_error_ == Errc::kBaudRefused) {
    log_line(EventPriority::kError, fmt::format("{}: {}: {} baud (lrf.baud); another rate or adapter is needed", device,
                                                describe(laser_error_), options_.params.lrf.baud));
    return EX_CONFIG;
  }
  if (laser_error_ != Errc::kDeviceMissing) {
    log_line(EventPriority::kError,
             fmt::format("{}: {} (lrf.device)", device, device_error_text(laser_error_, device)));
    return laser_error_ == Errc::kDeviceDenied ? EX_NOPERM
           : laser_error_ == Errc::kBadAddress ? EX_CONFIG
                                               : EX_UNAVAILABLE;
  }
  log_line(EventPriority::kWarning, fmt::format("{}: {}; it is opened as soon as it is there (lrf.device)", device,
                                                device_error_text(laser_error_, device)));
  surroundings_.device_tried = true;
  return EX_OK;
}

int Supervisor::open_control() {
  const std::string& path = options_.params.control.socket;
  const int error = path.empty() ? 0 : control_.open(path);
  if (error == 0) {
    return EX_OK;
  }
  std::string what = std::strerror(error);  // NOLINT(concurrency-mt-unsafe): one thread
  if (error == EADDRINUSE) {
    what = control_.other() > 0 ? fmt::format("another daemon, pid {}, takes commands there", control_.other())
                                : "another program takes commands there";
  } else if (error == ENOTSOCK) {
    what = "there is a file that is no socket, which is left as it is";
  }
  log_line(
      EventPriority::kError,
      fmt::format("{}: no socket for commands: {} (control.socket); a path is needed that is free, in a folder that "
                  "this user may write to, or \"\" for none",
                  path, what));
  return error == EADDRINUSE                 ? EX_UNAVAILABLE
         : error == ENAMETOOLONG             ? EX_CONFIG
         : error == EACCES || error == EPERM ? EX_NOPERM
                                             : EX_CANTCREAT;
}

void Supervisor::wait() {
  std::array<pollfd, 2> ready{pollfd{.fd = signals_.descriptor(), .events = POLLIN, .revents = 0},
                              pollfd{.fd = control_.descriptor(), .events = POLLIN, .revents = 0}};
  const timespec timeout{.tv_sec = 0, .tv_nsec = kRound_ns};
  static_cast<void>(::ppoll(ready.data(), ready.size(), &timeout, nullptr));
  handle_signals();
  control_.serve(machine_.clock().now_ns(),
                 [this](std::string_view line, const ControlPeer& peer) { return answer(line, peer); });
}

void Supervisor::handle_signals() {
  constexpr int kMost = 8;  // in a round, however fast they come
  for (int i = 0; i < kMost; ++i) {
    const SignalMeaning meaning = signals_.next();
    if (meaning == SignalMeaning::kReload) {
      reload();
    } else if (meaning == SignalMeaning::kEnd && !std::exchange(ending_, true)) {
      log_line(EventPriority::kNotice, fmt::format("signal {}: the daemon ends", signals_.name()));
    }
  }
}

void Supervisor::keep_laser_open() {
  if (!machine_.reads_laser()) {
    return;
  }
  const Errc error = keeper_.tick(machine_.clock().now_ns());
  if (error != Errc::kOk && error != laser_error_) {
    log_line(EventPriority::kWarning,
             fmt::format("{}: {}", options_.params.lrf.device, device_error_text(error, options_.params.lrf.device)));
  }
  if (error != Errc::kOk) {
    laser_error_ = error;
    surroundings_.device_tried = true;
  } else if (!machine_.line().is_empty()) {
    laser_error_ = Errc::kOk;
    surroundings_.device_tried = false;
  }
}

// A servo that cannot be opened stops nothing: SLAM goes on, and health says so.
void Supervisor::keep_tilt_open() {
  if (machine_.tilt() == nullptr) {
    return;
  }
  const Errc error = tilt_keeper_.tick(machine_.clock().now_ns());
  if (error != Errc::kOk && error != tilt_error_) {
    log_line(EventPriority::kWarning,
             fmt::format("{}: {}; it is opened as soon as it can be (tilt.device)", options_.params.tilt.device,
                         device_error_text(error, options_.params.tilt.device)));
  }
  if (error != Errc::kOk || !machine_.tilt_line().is_empty()) {
    tilt_error_ = error;
  }
}

bool Supervisor::watch() {
  const std::int64_t now_ns = machine_.clock().now_ns();
  if (now_ns >= next_look_ns_) {
    next_look_ns_ = now_ns + StageWatch::kLook_ns;
    stage_watch_->look();
  }
  if (now_ns >= next_watch_ns_) {
    next_watch_ns_ = now_ns + kWatch_ns;
    tell(now_ns);
  }
  const StageWatch::Silence silence = stage_watch_->longest();
  if (silence.lasts_ns < options_.params.pipeline.watchdog_ns) {
    return true;
  }
  log_line(EventPriority::kCritical,
           fmt::format("the {} stage does not answer: ending, to be restarted (pipeline.watchdog_ms)", silence.stage));
  return false;
}

void Supervisor::tell(std::int64_t now_ns) {
  surroundings_.stage_silent = stage_watch_->longest().lasts_ns > options_.params.pipeline.watchdog_ns / 2;
  follow_gpio();
  surroundings_.save_error = saver_.error();
  machine_.publisher().set_surroundings(surroundings_, now_ns);
  const std::string state = state_sentence(machine_.publisher().health());
  remember_state(state);
  if (!surroundings_.stage_silent) {
    notify_service_manager("WATCHDOG=1\nSTATUS=" + state);
  }
}

void Supervisor::follow_gpio() {
  GpioSignals& gpio = machine_.gpio();
  const std::int64_t now_ns = machine_.clock().now_ns();
  const bool silent = gpio.is_silent(now_ns);
  if (silent != std::exchange(gpio_silent_, silent)) {
    log_line(
        EventPriority::kError,
        silent ? "GPIO: a line does not answer (a stuck bus, or gpio.priority is too low): a gpio.stop_line counts as "
                 "pressed until it does"
               : "GPIO: its lines answer again");
  }
  if (const bool stopped = gpio.is_stopped(now_ns); stopped != surroundings_.stopped) {
    surroundings_.stopped = stopped;
    log_line(EventPriority::kWarning,
             stopped ? "emergency stop: pressed, or its line is lost or not read" : "emergency stop: released");
  }
  if (const bool lost = gpio.line_lost || gpio.sync_missing || silent; lost != surroundings_.gpio_lost) {
    surroundings_.gpio_lost = lost;
    log_line(EventPriority::kWarning,
             lost ? "GPIO: a line cannot be used, or the sync pulse is missing ([gpio])" : "GPIO: all lines are there");
  }
  if (const std::int64_t cycles = gpio.power_cycles; cycles != power_cycles_) {
    power_cycles_ = cycles;
    log_line(EventPriority::kWarning, "laser: without a scan for too long: switched off and on (gpio.power_line)");
  }
  gpio.state = machine_.publisher().health().state;
}

void Supervisor::reload() {
  DaemonParams params = options_.params;
  const std::string wrong = options_.reload ? options_.reload(params) : "there is no configuration file";
  if (!wrong.empty()) {
    log_line(EventPriority::kError, fmt::format("the configuration stays as it was: {}", wrong));
    return;
  }
  options_.params.health = params.health;
  machine_.publisher().set_health_params(params.health);
  log_line(EventPriority::kNotice, "configuration read: [health] is in force; all else needs a restart");
}

std::string Supervisor::answer(std::string_view line, const ControlPeer& peer) {
  const std::variant<ControlCommand, std::string> parsed = parse_control_command(line);
  if (const auto* const refusal = std::get_if<std::string>(&parsed)) {
    return "error: " + *refusal + "\n";
  }
  const auto& command = std::get<ControlCommand>(parsed);
  const std::string said = commands_.obey(command);
  if (!command.only_asks()) {
    log_line(EventPriority::kNotice, fmt::format("command '{}' of user {}, pid {}: {}", line, peer.uid, peer.pid,
                                                 said.substr(0, said.find('\n'))));
  }
  return said;
}

// Commands are answered meanwhile, and the service manager is told that it takes its time as long as it gets on.
void Supervisor::wait_for_saver() {
  const WorldKeeper* const world = machine_.publisher().world();
  while (true) {
    const bool is_saving = saver_.is_saving();
    if (!is_saving && (world == nullptr || !world->is_ending())) {
      return;
    }
    const std::string doing = is_saving ? saver_.status().doing : "writing the world file";
    const std::int64_t now_ns = machine_.clock().now_ns();
    if ((is_saving ? now_ns - saver_.progress_ns() : world->since_progress_ns()) > kStuck_ns) {
      log_line(EventPriority::kCritical, fmt::format("saving makes no progress ({}): given up", doing));
      ::_exit(EX_CANTCREAT);
    }
    if (now_ns >= next_watch_ns_) {
      next_watch_ns_ = now_ns + kWatch_ns;
      notify_service_manager(fmt::format("WATCHDOG=1\nEXTEND_TIMEOUT_USEC=10000000\nSTATUS=ends: {}", doing));
    }
    wait();
  }
}

/// After a save that is under way, the world file first. @return  Whether there was nothing to do, or it went well.
bool Supervisor::save_last(bool is_complete) {
  WorldKeeper* const world = machine_.publisher().world();
  if (world != nullptr) {
    world->begin_end();
  }
  wait_for_saver();
  const bool is_kept = world == nullptr || world->report().error == 0;
  if (options_.folder.empty()) {
    return is_kept;
  }
  const bool has_begun = saver_.begin({.is_last = is_complete});
  wait_for_saver();
  return has_begun && is_kept && saver_.status().state == SaveStatus::State::kSaved;
}

int Supervisor::end() {
  ending_ = true;
  notify_service_manager("STOPPING=1");
  end_process_after(kEnd_s, EX_SOFTWARE);
  if (!machine_.stop()) {
    end_without_stages();
  }
  let_process_end_in_its_time();  // a large map may take long on a slow disk
  const int status = save_last(true) ? EX_OK : EX_CANTCREAT;
  end_process_after(kEnd_s, status);  // lines and threads are still to be closed
  return status;
}

// The map is then as it was published last, for nobody may touch the filter. What hangs may hold whatever saving needs.
void Supervisor::end_without_stages() {
  ending_ = true;
  notify_service_manager("STOPPING=1");
  end_process_after(kEnd_s, EX_SOFTWARE);
  static_cast<void>(save_last(false));
  ::_exit(EX_SOFTWARE);
}

}  // namespace odoless
