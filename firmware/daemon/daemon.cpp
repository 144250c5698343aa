#include "firmware/daemon/daemon.hpp"

#include <fmt/format.h>
#include <sysexits.h>

#include "firmware/daemon/crash_report.hpp"
#include "firmware/daemon/log.hpp"
#include "firmware/daemon/machine.hpp"
#include "firmware/daemon/signals.hpp"
#include "firmware/daemon/start_up.hpp"
#include "firmware/daemon/supervisor.hpp"
#include "firmware/daemon/web_commands.hpp"
#include "firmware/web/web_server.hpp"
#include "rt/memory_lock.hpp"
#include "rt/stop_flag.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kPublishRound_ns = 5'000'000;

/// The publisher's thread, as long as it lives.
class PublisherThread {
 public:
  explicit PublisherThread(Machine& machine) : machine_(machine) {}
  ~PublisherThread() { stop_.request(); }  // its thread then joins
  PublisherThread(const PublisherThread&) = delete;
  PublisherThread& operator=(const PublisherThread&) = delete;

  /// 0, or the errno for which there is no thread.
  [[nodiscard]] int start() {
    return thread_.start([this] {
      while (!stop_.requested()) {
        machine_.publisher().round(machine_.clock().now_ns());
        sleep_ns(kPublishRound_ns);
      }
    });
  }

 private:
  Machine& machine_;
  StopFlag stop_;
  RealTimeThread thread_{{.name = "odo-publisher", .stack_bytes = kPublisherStack_bytes}};
};

int refuse(const Lack& lack) {
  log_line(EventPriority::kError, lack.text);
  return lack.status;
}

int refuse_thread(int error) {
  return refuse({EX_OSERR, fmt::format("a thread cannot be made: {}", reason_of(error))});
}

std::unique_ptr<WebServer> make_page(const DaemonParams& params, Machine& machine) {
  return params.web.is_used() ? std::make_unique<WebServer>(params.web, *machine.publisher().live(),
                                                            [socket = params.control.socket](std::string_view line) {
                                                              return obey_page(socket, line);
                                                            })
                              : nullptr;
}

bool refuse(const DaemonOptions& options, const char* what, int error) {
  log_line(options.require_realtime ? EventPriority::kError : EventPriority::kWarning,
           fmt::format("{}: {}; {}", what, reason_of(error),
                       options.require_realtime
                           ? "real time is required (--require-realtime)"
                           : "the daemon runs on without it (LimitRTPRIO and LimitMEMLOCK in systemd allow it)"));
  return options.require_realtime;
}

}  // namespace

int run_daemon(DaemonOptions options) {
  hold_standard_descriptors();
  block_signals();
  if (const Lack lack = lack_of_descriptors(WebServer::threads(options.params.web)); lack.status != EX_OK) {
    return refuse(lack);
  }
  if (const Lack lack = lack_of_folders(options); lack.status != EX_OK) {
    return refuse(lack);
  }
  const CrashReporter crashes(options.folder, "odolessd " + options.version);
  if (!crashes.previous().empty()) {
    log_line(EventPriority::kWarning, fmt::format("the run before crashed: {} has the report", crashes.previous()));
  }
  const int memory_error = lock_memory();
  if (memory_error != 0 && refuse(options, "memory cannot be locked", memory_error)) {
    return EX_NOPERM;
  }
  Machine machine(options);
  if (const Lack lack = lack_of_threads(machine.threads() + WebServer::threads(options.params.web));
      lack.status != EX_OK) {
    return refuse(lack);
  }
  if (const Lack lack = lack_of_memory(machine.map_cells()); lack.status != EX_OK) {
    return refuse(lack);
  }
  if (const Lack lack = machine.open(); lack.status != EX_OK) {
    return refuse(lack);
  }
  const std::unique_ptr<WebServer> page = make_page(options.params, machine);
  if (const std::string wrong = page ? page->open() : ""; !wrong.empty()) {
    return refuse({EX_UNAVAILABLE, wrong});
  }
  Supervisor supervisor(options, machine, memory_error != 0 ? kReasonNotRealTime : 0U);
  if (const int status = supervisor.open(); status != EX_OK) {
    return status;
  }
  if (const int error = machine.start(options.enforce_realtime); error != 0) {
    return refuse_thread(error);
  }
  if (const int error = machine.scheduling_error(); error != 0) {
    if (refuse(options, "real-time scheduling is refused", error)) {
      return EX_NOPERM;
    }
    supervisor.add_standing_reason(kReasonNotRealTime);
  }
  PublisherThread publisher(machine);
  if (const int error = publisher.start(); error != 0) {
    return refuse_thread(error);
  }
  if (const int error = supervisor.start(); error != 0) {
    return refuse_thread(error);
  }
  if (const int error = page ? page->start() : 0; error != 0) {
    return refuse_thread(error);
  }
  if (page) {
    log_line(EventPriority::kNotice, fmt::format("page: http://{}/", options.params.web.listen));
  }
  return supervisor.run();
}

}  // namespace odoless
