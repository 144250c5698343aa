#include "tools/emulate/lrf_emulator.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <ctime>
#include <deque>
#include <fstream>
#include <utility>

#include "rt/cpu_clock.hpp"
#include "tools/command/error.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kIdleNs = 20'000'000;  ///< between looks at a line that no client has open
constexpr std::size_t kWaitingMax = 4;        ///< scans that wait for a client that doesn't read

std::int64_t epoch_offset_ns() {
  const auto realtime = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(realtime).count() - monotonic_ns();
}

/// SIGTERM and SIGINT, blocked while this lives but for the time that `ppoll` waits with `mask`.
class StopSignals {
 public:
  StopSignals() {
    stopped_ = 0;
    struct sigaction action {};
    action.sa_handler = [](int) { stopped_ = 1; };
    sigset_t stops;
    sigemptyset(&stops);
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
      sigaddset(&stops, kSignals[i]);
      sigaction(kSignals[i], &action, &before_[i]);
    }
    pthread_sigmask(SIG_BLOCK, &stops, &mask_);
  }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  ~StopSignals() {
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
      sigaction(kSignals[i], &before_[i], nullptr);
    }
    pthread_sigmask(SIG_SETMASK, &mask_, nullptr);
  }

  [[nodiscard]] const sigset_t& mask() const { return mask_; }
  [[nodiscard]] static bool stopped() { return stopped_ != 0; }

 private:
  static constexpr std::array<int, 2> kSignals{SIGTERM, SIGINT};
  static inline volatile std::sig_atomic_t stopped_ = 0;
  std::array<struct sigaction, 2> before_{};
  sigset_t mask_{};
};

class Emulation {
 public:
  Emulation(EmulatedLrf& device, const ScanSource& source, EmulatedLine& line, const std::string& truth)
      : device_(device), source_(source), line_(line) {
    if (!truth.empty()) {
      truth_.open(truth);
      if (!truth_) {
        throw CannotCreateError(truth + ": cannot be created");
      }
    }
  }

  /// One round: what the client sent, what is due, and what the line takes.
  void step(bool has_client) {
    const std::int64_t now_ns = monotonic_ns();
    device_.set_line_baud(line_.baud());
    if (const std::string bytes = has_client ? line_.read() : std::string(); !bytes.empty()) {
      device_.receive(bytes, now_ns);
    }
    device_.tick(now_ns);
    for (SentBytes& sent : device_.take_output()) {
      queue(std::move(sent), has_client);
    }
    if (!has_client) {
      waiting_.clear();
      begun_bytes_ = 0;
    }
    write();
  }

  [[nodiscard]] bool has_waiting() const { return !waiting_.empty(); }
  [[nodiscard]] const LrfEmulation& done() const { return done_; }

 private:
  void queue(SentBytes sent, bool has_client) {
    const bool is_scan = sent.scan.has_value();
    if (has_client && (!is_scan || waiting_.size() < kWaitingMax)) {
      waiting_.push_back(std::move(sent));
    } else {
      done_.dropped += is_scan ? 1 : 0;
    }
  }

  void write() {
    while (!waiting_.empty()) {
      const SentBytes& sent = waiting_.front();
      const std::string_view rest = std::string_view(sent.bytes).substr(begun_bytes_);
      const std::size_t written = line_.write(sent.one_by_one ? rest.substr(0, 1) : rest);
      begun_bytes_ += written;
      if (begun_bytes_ < sent.bytes.size()) {
        if (written == 0) {
          return;
        }
        continue;
      }
      if (sent.scan) {
        ++done_.scans;
        tell_truth(*sent.scan);
      }
      waiting_.pop_front();
      begun_bytes_ = 0;
    }
  }

  void tell_truth(const SentScan& scan) {
    const std::optional<Pose2> world_T_robot =
        source_.world_T_robot(device_.source_time_ns(scan.first_beam_ns).value_or(0));
    if (!truth_.is_open() || !world_T_robot) {
      return;
    }
    const std::int64_t stamp_us = (scan.first_beam_ns + epoch_offset_ns_) / 1000;
    truth_ << fmt::format("{}.{:06} {:.9f} {:.9f} 0 0 0 {:.9f} {:.9f}\n", stamp_us / 1'000'000, stamp_us % 1'000'000,
                          world_T_robot->x_m, world_T_robot->y_m, std::sin(world_T_robot->yaw_rad / 2.0),
                          std::cos(world_T_robot->yaw_rad / 2.0))
           << std::flush;
    if (!truth_) {
      throw IoError("writing the truth failed");
    }
  }

  EmulatedLrf& device_;
  const ScanSource& source_;
  EmulatedLine& line_;
  std::ofstream truth_;
  std::int64_t epoch_offset_ns_ = epoch_offset_ns();
  std::deque<SentBytes> waiting_;
  std::size_t begun_bytes_ = 0;  ///< of the first that waits: already written
  LrfEmulation done_;
};

timespec to_timespec(std::int64_t duration_ns) {
  return {.tv_sec = duration_ns / 1'000'000'000, .tv_nsec = duration_ns % 1'000'000'000};
}

/// Waits until the client sends, the line takes more, or it is time.
void wait(const EmulatedLine& line, const Emulation& emulation, bool has_client, std::int64_t until_ns,
          const sigset_t& mask) {
  const std::int64_t longest_ns = has_client ? 200'000'000 : kIdleNs;
  const timespec timeout = to_timespec(std::clamp<std::int64_t>(until_ns - monotonic_ns(), 0, longest_ns));
  const auto events = static_cast<short>(POLLIN | (emulation.has_waiting() ? POLLOUT : 0));
  pollfd poll{.fd = has_client ? line.descriptor() : line.idle_descriptor(), .events = events, .revents = 0};
  static_cast<void>(::ppoll(&poll, 1, &timeout, &mask));
}

}  // namespace

LrfEmulation emulate_lrf(EmulatedLrf& device, const ScanSource& source, EmulatedLine& line,
                         const LrfEmulatorOptions& options, const std::function<void()>& on_end) {
  const StopSignals signals;
  Emulation emulation(device, source, line, options.truth);
  const std::int64_t start_ns = monotonic_ns();
  bool ended = false;
  while (!StopSignals::stopped() && monotonic_ns() - start_ns < options.duration_ns) {
    const bool has_client = line.has_client();
    emulation.step(has_client);
    if (!ended && device.source_time_ns(monotonic_ns()).value_or(0) > source.duration_ns()) {
      ended = true;
      on_end();
    }
    if (ended && options.stops_at_end) {
      break;
    }
    const std::int64_t left_ns = options.duration_ns - (monotonic_ns() - start_ns);
    wait(line, emulation, has_client,
         std::min(device.next_event_ns(), left_ns > kIdleNs ? device.next_event_ns() : monotonic_ns() + left_ns),
         signals.mask());
  }
  return emulation.done();
}

}  // namespace odoless
