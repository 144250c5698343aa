#include "tools/emulate/lrf_emulator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/math/elementary.hpp"
#include "rt/cpu_clock.hpp"
#include "tools/command/error.hpp"

namespace odoless {
namespace {

constexpr std::ptrdiff_t kWaitingMax = 4;  ///< scans that wait for a client that doesn't read

std::int64_t epoch_offset_ns() {
  const auto realtime = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(realtime).count() - monotonic_ns();
}

}  // namespace

LoopedLrf::LoopedLrf(EmulatedLrf& device, const EmulatedScans& source, EmulatedLine& line, const std::string& truth,
                     std::function<void()> on_end)
    : device_(device), source_(source), line_(line), on_end_(std::move(on_end)), epoch_offset_ns_(epoch_offset_ns()) {
  if (!truth.empty()) {
    truth_.open(truth);
    if (!truth_) {
      throw CannotCreateError(truth + ": cannot be created");
    }
  }
}

void LoopedLrf::step(std::int64_t now_ns) {
  has_client_ = line_.has_client();
  device_.set_line_baud(line_.baud());
  if (const std::string bytes = has_client_ ? line_.read() : std::string(); !bytes.empty()) {
    device_.receive(bytes, now_ns);
  }
  device_.tick(now_ns);
  for (SentBytes& sent : device_.take_output()) {
    queue(std::move(sent));
  }
  if (!has_client_) {
    waiting_.clear();
    begun_bytes_ = 0;
  }
  write();
  if (!is_over_ && device_.source_time_ns(now_ns).value_or(0) > source_.duration_ns()) {
    is_over_ = true;
    on_end_();
  }
}

pollfd LoopedLrf::waits_for() {
  const auto events = static_cast<short>(POLLIN | (waiting_.empty() ? 0 : POLLOUT));
  return {.fd = has_client_ ? line_.descriptor() : line_.idle_descriptor(), .events = events, .revents = 0};
}

// Some lasers send a scan in hundreds of pieces, and all that a machine has kept from running measured meanwhile is due
// at once.
void LoopedLrf::queue(SentBytes sent) {
  const bool is_scan = sent.scan.has_value();
  const auto completes_scan = [](const SentBytes& piece) { return piece.scan.has_value(); };
  if (has_client_ && (!is_scan || std::ranges::count_if(waiting_, completes_scan) < kWaitingMax)) {
    waiting_.push_back(std::move(sent));
  } else {
    done_.dropped += is_scan ? 1 : 0;
  }
}

void LoopedLrf::write() {
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

void LoopedLrf::tell_truth(const SentScan& scan) {
  const std::optional<Pose2> world_T_robot =
      source_.world_T_robot(device_.source_time_ns(scan.first_beam_ns).value_or(0));
  if (!truth_.is_open() || !world_T_robot) {
    return;
  }
  const std::int64_t stamp_us = (scan.first_beam_ns + epoch_offset_ns_) / 1000;
  truth_ << fmt::format("{}.{:06} {:.9f} {:.9f} 0 0 0 {:.9f} {:.9f}\n", stamp_us / 1'000'000, stamp_us % 1'000'000,
                        world_T_robot->x_m, world_T_robot->y_m, math::sin(world_T_robot->yaw_rad / 2.0),
                        math::cos(world_T_robot->yaw_rad / 2.0))
         << std::flush;
  if (!truth_) {
    throw IoError("writing the truth failed");
  }
}

}  // namespace odoless
