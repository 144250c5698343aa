#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "drivers/io/file_descriptor.hpp"

namespace odoless {

/// While there is one, a crash (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT) writes a report before it takes its course:
/// signal, place in the program, build, state, last log lines. It goes to `.crash` in the folder, which is opened
/// beforehand, so that writing is all that is left to do, and to standard error in one line. What is mapped is in the
/// world file.
///
/// A thread that has overflowed its stack reports nothing, for there is nowhere to do so; nor one of
/// `--enforce-realtime` that aborts itself, which the kernel kills for that.
class CrashReporter {
 public:
  /// @param folder   Empty: there is no file. @param program  Name and version, for the report's first line.
  CrashReporter(const std::filesystem::path& folder, std::string_view program);
  /// Crashes are as without it, and nothing is left in the folder.
  ~CrashReporter();
  CrashReporter(const CrashReporter&) = delete;
  CrashReporter& operator=(const CrashReporter&) = delete;

  /// Where the report of the run before is now, which crashed; empty: it did not.
  [[nodiscard]] const std::string& previous() const { return previous_; }

 private:
  void open(const std::filesystem::path& folder);

  std::filesystem::path path_;
  FileDescriptor file_;
  std::string previous_;
};

/// For a report: a line of the log, the state. Thread: any ordinary one.
void remember_log_line(std::string_view text);
void remember_state(std::string_view text);

}  // namespace odoless
