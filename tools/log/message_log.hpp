#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "tools/log/byte_stream.hpp"
#include "tools/log/scan_log.hpp"

namespace odoless {

/// A scan, or what is wrong with the message that should have been one.
using DecodedScan = std::variant<LogScan, std::string>;

/// A log of messages, each of a topic, read one by one.
class MessageLog {
 public:
  MessageLog(const char* format, std::string name) : format_(format), name_(std::move(name)) {}
  MessageLog(const MessageLog&) = delete;
  MessageLog(MessageLog&&) = delete;
  MessageLog& operator=(const MessageLog&) = delete;
  MessageLog& operator=(MessageLog&&) = delete;
  virtual ~MessageLog() = default;

  /// Goes on to the next message, and counts it for its topic; false at the end.
  /// @throws DataError for a damaged or cut file, IoError.
  [[nodiscard]] bool next();

  /// The topic of the last message, an index of `topics`.
  [[nodiscard]] std::size_t topic() const { return topic_; }

  /// The scan that the last message is, where its topic has scans. @throws DataError.
  [[nodiscard]] LogScan scan();

  [[nodiscard]] const std::vector<LogTopic>& topics() const { return topics_; }

  /// What is there in place of scans, where it is something that this format's user may take for scans.
  [[nodiscard]] virtual std::string advice() const { return ""; }

  /// What had to be passed over, a sentence; empty: nothing.
  [[nodiscard]] virtual std::string passed_over() const { return ""; }

  [[nodiscard]] const char* format() const { return format_; }
  [[nodiscard]] const std::string& name() const { return name_; }

 protected:
  /// A message's topic and when it was recorded.
  struct Head {
    std::size_t topic = 0;
    std::int64_t recorded_ns = 0;
  };

  /// Reads the next message; false at the end.
  [[nodiscard]] virtual bool read(Head& head) = 0;
  [[nodiscard]] virtual DecodedScan decode() = 0;

  /// The topic of this name and type, which is made where there is none yet. @throws DataError for too many.
  [[nodiscard]] std::size_t topic_of(std::string_view name, std::string_view type, bool has_scans);

 private:
  const char* format_;
  std::string name_;
  std::vector<LogTopic> topics_;
  std::size_t topic_ = 0;
};

/// One format of such logs.
struct MessageFormat {
  const char* name;
  /// Whether a file that begins so (up to 64 bytes, unpacked) is one.
  bool (*is_one)(std::string_view head);
  std::unique_ptr<MessageLog> (*open)(std::unique_ptr<ByteStream> bytes, const std::filesystem::path& path);
};

/// The format of a file that begins so, or null.
[[nodiscard]] const MessageFormat* find_message_format(std::string_view head);

/// Its scans, of the topic chosen; of the only one that has scans where none is. @throws DataError.
[[nodiscard]] ScanLog read_scans(MessageLog& log, const LogChoice& choice);

}  // namespace odoless
