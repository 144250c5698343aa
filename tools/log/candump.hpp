#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/io/can_frame.hpp"

namespace odoless {

/// A frame on a CAN bus, as recorded.
struct RecordedCanFrame {
  std::int64_t stamp_us = 0;
  std::string interface;
  CanFrame frame;

  bool operator==(const RecordedCanFrame&) const = default;
};

/// A line of the log format of can-utils' candump (candump -L), which canplayer replays, without its end:
/// (1700000000.123456) can0 181#3706000000000001
[[nodiscard]] std::string candump_line(const RecordedCanFrame& recorded);

/// Reads such a line; nothing where it is none. A direction behind the frame (candump -x) is allowed. CAN FD is not.
[[nodiscard]] std::optional<RecordedCanFrame> parse_candump_line(std::string_view line);

/// Reads a whole log. @throws NoInputError, DataError with file and line.
[[nodiscard]] std::vector<RecordedCanFrame> read_candump(const std::filesystem::path& path);

/// Writes a log line by line. @throws CannotCreateError, IoError.
class CandumpWriter {
 public:
  explicit CandumpWriter(const std::filesystem::path& path);
  void write(const RecordedCanFrame& recorded);

 private:
  std::string path_;
  std::ofstream file_;
};

}  // namespace odoless
