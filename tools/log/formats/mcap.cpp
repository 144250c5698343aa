// MCAP, as ROS 2 and Foxglove write it: messages in CDR, or in ROS 1's encoding where a bag was converted.
#include <fmt/core.h>

#include <map>

#include "tools/log/binary_cursor.hpp"
#include "tools/log/formats/chunk.hpp"
#include "tools/log/formats/formats.hpp"
#include "tools/log/formats/laser_scan.hpp"
#include "tools/log/formats/mcap_format.hpp"

namespace odoless {
namespace {

using namespace mcap;  // NOLINT(google-build-using-namespace)

constexpr const char* kUndamaged = "an undamaged MCAP file; `mcap doctor` says more";
constexpr std::size_t kChunkHeadBytesMax = 1024;
constexpr std::size_t kNameBytesMax = 255;

struct Channel {
  std::size_t topic = 0;
  RosEncoding encoding = RosEncoding::kCdr;
};

class McapLog : public MessageLog {
 public:
  McapLog(std::unique_ptr<ByteStream> bytes, const std::string& name)
      : MessageLog("MCAP", name), file_(std::move(bytes), name) {
    file_.skip(kMagic.size());
  }

 protected:
  bool read(Head& head) override {
    while (!is_at_end_) {
      if (chunk_ && chunk_->at_end()) {
        chunk_.reset();
      }
      if (!chunk_ && file_.at_end()) {
        file_.fail("the file ends without its summary", "a whole MCAP file; `mcap recover` mends one that is cut");
      }
      if (read_record(chunk_ ? *chunk_ : file_, head)) {
        return true;
      }
    }
    return false;
  }

  DecodedScan decode() override { return decode_laser_scan(message_, encoding_); }

 private:
  /// True for a message.
  bool read_record(BinaryStream& stream, Head& head) {
    BinaryCursor start(stream.take(sizeof(std::uint8_t) + sizeof(std::uint64_t)));
    const auto op = start.number<std::uint8_t>();
    const auto size_bytes = start.number<std::uint64_t>();
    switch (op) {
      case kMessage:
        read_message(stream, size_bytes, head);
        return true;
      case kSchema:
        read_schema(stream, size_bytes);
        return false;
      case kChannel:
        read_channel(stream, size_bytes);
        return false;
      case kChunk:
        open(stream, size_bytes);
        return false;
      case kDataEnd:
        is_at_end_ = true;
        [[fallthrough]];
      default:  // also what a later version may add
        stream.skip(size_bytes);
        return false;
    }
  }

  void read_schema(BinaryStream& stream, std::uint64_t size_bytes) {
    BinaryCursor cursor(stream.take(size_bytes));
    const auto id = cursor.number<std::uint16_t>();
    const std::string_view name = cursor.text();
    check(cursor, stream);
    schemas_[id] = name.substr(0, kNameBytesMax);
  }

  void read_channel(BinaryStream& stream, std::uint64_t size_bytes) {
    BinaryCursor cursor(stream.take(size_bytes));
    const auto id = cursor.number<std::uint16_t>();
    const auto schema = cursor.number<std::uint16_t>();
    const std::string_view topic = cursor.text();
    const std::string_view encoding = cursor.text();
    check(cursor, stream);
    const std::string& type = schemas_[schema];
    const bool can_be_read = encoding == "cdr" || encoding == "ros1";
    channels_[id] = {topic_of(topic, can_be_read ? type : fmt::format("{} as {}", type, encoding.substr(0, 20)),
                              can_be_read && is_laser_scan(type)),
                     encoding == "ros1" ? RosEncoding::kRos1 : RosEncoding::kCdr};
  }

  void read_message(BinaryStream& stream, std::uint64_t size_bytes, Head& head) {
    constexpr std::size_t kHeadBytes = 22;
    if (size_bytes < kHeadBytes) {
      stream.fail(fmt::format("a message of {} bytes", size_bytes), kUndamaged);
    }
    BinaryCursor cursor(stream.take(kHeadBytes));
    const auto channel = channels_.find(cursor.number<std::uint16_t>());
    cursor.number<std::uint32_t>();  // the sequence number
    if (channel == channels_.end()) {
      stream.fail("a message of no known channel", kUndamaged);
    }
    head.topic = channel->second.topic;
    head.recorded_ns = cursor.number<std::int64_t>();
    encoding_ = channel->second.encoding;
    message_ = {};
    if (topics()[head.topic].has_scans) {
      message_ = stream.take(size_bytes - kHeadBytes);
    } else {
      stream.skip(size_bytes - kHeadBytes);
    }
  }

  void open(BinaryStream& stream, std::uint64_t size_bytes) {
    if (&stream != &file_) {
      stream.fail("a chunk within a chunk", kUndamaged);
    }
    ChunkHead head;
    BinaryCursor cursor(file_.peek(kChunkHeadBytesMax));
    cursor.number<std::uint64_t>();  // first and last time
    cursor.number<std::uint64_t>();
    head.unpacked_bytes = cursor.number<std::uint64_t>();
    head.crc32 = cursor.number<std::uint32_t>();
    head.packing = cursor.text();
    head.packed_bytes = cursor.number<std::uint64_t>();
    constexpr std::uint64_t kFixedBytes = 40;
    const std::uint64_t head_bytes = kFixedBytes + head.packing.size();
    if (!cursor.ok() || size_bytes < head_bytes || head.packed_bytes != size_bytes - head_bytes) {
      stream.fail("a chunk whose lengths don't fit to each other", kUndamaged);
    }
    file_.skip(head_bytes);
    chunk_ = open_chunk(file_, head);
  }

  static void check(const BinaryCursor& cursor, const BinaryStream& stream) {
    if (!cursor.ok()) {
      stream.fail("a schema or a channel that is shorter than its own counts say", kUndamaged);
    }
  }

  BinaryStream file_;
  std::unique_ptr<BinaryStream> chunk_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  std::string_view message_;
  RosEncoding encoding_ = RosEncoding::kCdr;
  bool is_at_end_ = false;
};

}  // namespace

bool is_mcap(std::string_view head) { return head.starts_with(kMagic); }

std::unique_ptr<MessageLog> open_mcap(std::unique_ptr<ByteStream> bytes, const std::filesystem::path& path) {
  return std::make_unique<McapLog>(std::move(bytes), path.string());
}

}  // namespace odoless
