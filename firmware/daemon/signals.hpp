#pragma once

#include <string>

#include "drivers/io/file_descriptor.hpp"

namespace odoless {

/// Blocks every signal that would end the process at its pleasure (SIGTERM, SIGINT, SIGQUIT, SIGUSR1, timers, limits,
/// real-time signals), and SIGHUP, on this thread and those that it makes, so that `SignalReader` gets them; SIGPIPE is
/// ignored. Left as they are: SIGKILL, SIGABRT and those of a crash (crash_report.hpp), which end the process at once,
/// and SIGSTOP and its kin. To be called while there is one thread.
void block_signals();

/// What a signal asks for.
enum class SignalMeaning {
  kNone,    ///< none has come
  kReload,  ///< SIGHUP
  kEnd,     ///< any other
};

/// Reads the signals that were blocked. Thread: supervisor.
class SignalReader {
 public:
  SignalReader();

  /// Readable when a signal has come.
  [[nodiscard]] int descriptor() const { return descriptor_.get(); }
  /// The next one. A file that has grown to its limit (SIGXFSZ from ourselves) asks for nothing: the write has failed,
  /// and who wrote says so.
  [[nodiscard]] SignalMeaning next();
  /// Of the last one that asked for something: its name without SIG, or its number.
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  FileDescriptor descriptor_;
  std::string name_;
};

/// From now on the process ends with this exit status when the time is over, whatever its threads are doing.
void end_process_after(unsigned seconds, int status);
/// No more so.
void let_process_end_in_its_time();

}  // namespace odoless
