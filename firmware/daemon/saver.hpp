#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>

#include "firmware/daemon/machine.hpp"
#include "firmware/health/status.hpp"
#include "rt/real_time_thread.hpp"

namespace odoless {

/// Saves on a thread of its own, of ordinary priority, so that nobody else waits for a disk or for a map to be
/// rendered.
///
/// Thread: all methods from the supervisor's.
class Saver {
 public:
  Saver(const DaemonOptions& options, Machine& machine);
  /// Waits for a save that is under way.
  ~Saver();
  Saver(const Saver&) = delete;
  Saver& operator=(const Saver&) = delete;

  /// Starts the thread. @return  0, or the errno for which there is none.
  [[nodiscard]] int start();

  /// Begins a save. @return  False while one is under way.
  [[nodiscard]] bool begin(const SaveRequest& request);
  [[nodiscard]] bool is_saving() const { return status().state == SaveStatus::State::kSaving; }
  [[nodiscard]] SaveStatus status() const;
  /// errno of the last save; 0: it went well, or there was none.
  [[nodiscard]] int error() const;
  /// When a save last got on.
  [[nodiscard]] std::int64_t progress_ns() const;

 private:
  void run();
  void save(const SaveRequest& request);
  void tell(const std::string& doing);

  const DaemonOptions& options_;
  Machine& machine_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool is_ending_ = false;
  SaveRequest request_;
  SaveStatus status_;
  int error_ = 0;
  std::int64_t since_ns_ = 0;
  std::int64_t progress_ns_ = 0;
  RealTimeThread thread_{{.name = "odo-saver", .stack_bytes = kPublisherStack_bytes}};
};

}  // namespace odoless
