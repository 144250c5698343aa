#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <string_view>

#include "firmware/lcm/lcm_link.hpp"
#include "firmware/lcm/log_writer_params.hpp"

namespace odoless {

/// Since construction.
struct LogWriterCounters {
  std::int64_t events = 0;  ///< written
  std::int64_t bytes = 0;   ///< of them
  std::int64_t errors = 0;  ///< events not written, and files not synchronised or deleted
  int last_error = 0;       ///< errno of the last error; 0: there was none
  std::int64_t files_opened = 0;
  std::int64_t files_deleted = 0;
};

/// Records messages as LCM event logs, which lcm-logplayer and lcm_eventlog read, in files of bounded size.
///
/// An event is in a file whole or not at all: one that was cut short by a full disk is taken off again. Errors are
/// counted and stop nothing; the next event is tried again. Numbers go on where those of earlier runs ended, and no
/// file is ever overwritten.
///
/// Thread: publisher thread only; writes files, and waits for the disk when it synchronises them.
/// Format: LCM event log: per event 0xEDA1DA01, event number, time in microseconds, sizes of channel and data, and
/// both, numbers with the highest byte first.
class LogWriter : public LcmTap {
 public:
  /// Looks for files of earlier runs; opens none.
  explicit LogWriter(LogWriterParams params);
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;
  LogWriter(LogWriter&&) = delete;
  LogWriter& operator=(LogWriter&&) = delete;
  ~LogWriter() override;

  void record(std::string_view channel, std::span<const std::byte> message, std::int64_t stamp_ns) override;

  /// Hands all to the disk and closes the file; the next event begins another one.
  void close();

  [[nodiscard]] const LogWriterCounters& counters() const { return counters_; }

 private:
  struct File {
    std::string path;
    std::int64_t size_bytes;
  };
  static constexpr std::size_t kHeaderBytes = 28;

  void find_earlier_files();
  [[nodiscard]] bool make_room(std::int64_t event_bytes, std::int64_t stamp_ns);
  [[nodiscard]] bool open_next();
  void delete_oldest();
  void append(std::span<const std::byte> header, std::string_view channel, std::span<const std::byte> message);
  void synchronise(std::int64_t stamp_ns);
  void count_error();

  LogWriterParams params_;
  int descriptor_ = -1;
  int next_number_ = 0;
  std::deque<File> files_;  ///< oldest first; the last is the open one, if one is
  std::int64_t event_number_ = 0;
  std::int64_t synchronised_stamp_ns_ = 0;
  std::int64_t refused_stamp_ns_ = 0;
  bool refused_ = false;  ///< the last file could not be opened
  LogWriterCounters counters_;
};

}  // namespace odoless
