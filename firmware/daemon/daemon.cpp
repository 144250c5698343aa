#include "firmware/daemon/daemon.hpp"

#include <fmt/format.h>
#include <sysexits.h>
#include <unistd.h>

#include <cstring>
#include <thread>

#include "firmware/daemon/log.hpp"
#include "firmware/daemon/machine.hpp"
#include "firmware/daemon/supervisor.hpp"
#include "rt/memory_lock.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kPublishRound_ns = 5'000'000;

std::string reason_of(int error) { return std::strerror(error); }  // NOLINT(concurrency-mt-unsafe)

/// The publisher's thread, as long as it lives.
class PublisherThread {
 public:
  explicit PublisherThread(Machine& machine)
      : thread_([this, &machine] {
          while (!stop_.load(std::memory_order_acquire)) {
            machine.publisher().round(machine.clock().now_ns());
            sleep_ns(kPublishRound_ns);
          }
        }) {}
  ~PublisherThread() {
    stop_.store(true, std::memory_order_release);
    thread_.join();
  }
  PublisherThread(const PublisherThread&) = delete;
  PublisherThread& operator=(const PublisherThread&) = delete;

 private:
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

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
  const int memory_error = lock_memory();
  if (memory_error != 0 && refuse(options, "memory cannot be locked", memory_error)) {
    return EX_NOPERM;
  }
  Machine machine(options);
  if (const std::string wrong = machine.open(); !wrong.empty()) {
    log_line(EventPriority::kError, wrong);
    return EX_CONFIG;
  }
  Supervisor supervisor(options, machine, memory_error != 0 ? kReasonNotRealTime : 0U);
  if (const int status = supervisor.open_laser(); status != EX_OK) {
    return status;
  }
  if (const int error = machine.start(options.enforce_realtime); error != 0) {
    log_line(EventPriority::kError, fmt::format("a thread cannot be made: {}", reason_of(error)));
    ::_exit(EX_OSERR);  // those that run already would have to be waited for
  }
  if (const int error = machine.scheduling_error(); error != 0) {
    if (refuse(options, "real-time scheduling is refused", error)) {
      static_cast<void>(machine.stop(1'000'000'000));
      return EX_NOPERM;
    }
    supervisor.add_standing_reason(kReasonNotRealTime);
  }
  const PublisherThread publisher(machine);
  return supervisor.run();
}

}  // namespace odoless
