// ROS 1 bags, format 2.0.
#include <fmt/core.h>

#include <functional>
#include <map>

#include "tools/log/binary_cursor.hpp"
#include "tools/log/formats/chunk.hpp"
#include "tools/log/formats/formats.hpp"
#include "tools/log/formats/laser_scan.hpp"
#include "tools/log/printable.hpp"

namespace odoless {
namespace {

constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";
constexpr std::string_view kAnyMagic = "#ROSBAG V";
constexpr const char* kLaserScanSum = "90c7ef2dc6895d81024acba2ac42f369";

enum Op : unsigned char {
  kMessage = 0x02,
  kBagHeader = 0x03,
  kIndex = 0x04,
  kChunk = 0x05,
  kChunkInfo = 0x06,
  kConnection = 0x07,
};

/// Named fields, as they stand before each record's data and within a connection's.
class BagFields {
 public:
  /// @throws DataError, as `stream` says it.
  BagFields(std::string_view bytes, const BinaryStream& stream) : stream_(stream) {
    BinaryCursor cursor(bytes);
    while (!cursor.rest().empty()) {
      const std::string_view field = cursor.text();
      const std::size_t equals = field.find('=');
      if (!cursor.ok() || equals == std::string_view::npos) {
        stream_.fail("a record's header is no list of fields", "an undamaged bag");
      }
      fields_.emplace(field.substr(0, equals), field.substr(equals + 1));
    }
  }

  [[nodiscard]] std::string text(const char* name) const {
    const auto found = fields_.find(name);
    return found == fields_.end() ? "" : found->second;
  }

  template <class Number>
  [[nodiscard]] Number number(const char* name) const {
    const std::string bytes = text(name);
    if (bytes.size() != sizeof(Number)) {
      stream_.fail(fmt::format("a record's field {} has {} bytes", name, bytes.size()),
                   fmt::format("{}", sizeof(Number)));
    }
    return BinaryCursor(bytes).number<Number>();
  }

 private:
  const BinaryStream& stream_;
  std::map<std::string, std::string, std::less<>> fields_;
};

class RosBag : public MessageLog {
 public:
  RosBag(std::unique_ptr<ByteStream> bytes, const std::string& name)
      : MessageLog("ROS 1 bag", name), file_(std::move(bytes), name) {
    if (file_.peek(kBagMagic.size()) != kBagMagic) {
      file_.fail("a bag of another version", "version 2.0, to which `rosbag fix` brings older ones");
    }
    file_.skip(kBagMagic.size());
  }

  [[nodiscard]] std::string passed_over() const override {
    return is_closed_ ? "" : "the bag was never closed: its end may be missing";
  }

 protected:
  bool read(Head& head) override {
    while (true) {
      if (chunk_ && chunk_->at_end()) {
        chunk_.reset();
      }
      if (!chunk_ && file_.at_end()) {
        check_end();
        return false;
      }
      if (read_record(chunk_ ? *chunk_ : file_, head)) {
        return true;
      }
    }
  }

  DecodedScan decode() override { return decode_laser_scan(message_, RosEncoding::kRos1); }

 private:
  static std::uint32_t length(BinaryStream& stream) {
    return BinaryCursor(stream.take(sizeof(std::uint32_t))).number<std::uint32_t>();
  }

  /// True for a message.
  bool read_record(BinaryStream& stream, Head& head) {
    const BagFields fields(stream.take(length(stream)), stream);
    const std::uint32_t data_bytes = length(stream);
    switch (fields.number<std::uint8_t>("op")) {
      case kMessage:
        read_message(stream, fields, data_bytes, head);
        return true;
      case kConnection:
        read_connection(fields, BagFields(stream.take(data_bytes), stream), stream);
        return false;
      case kChunk:
        open(fields, data_bytes, stream);
        return false;
      case kBagHeader:
        read_bag_header(fields, stream);
        break;
      case kIndex:
      case kChunkInfo:
        break;
      default:
        stream.fail(fmt::format("a record of unknown kind {}", fields.number<std::uint8_t>("op")), "an undamaged bag");
    }
    stream.skip(data_bytes);
    return false;
  }

  void read_bag_header(const BagFields& fields, BinaryStream& stream) {
    if (!fields.text("encryptor").empty()) {
      stream.fail("the bag is encrypted", "one that is not");
    }
    is_closed_ = fields.number<std::uint64_t>("index_pos") != 0;
    chunks_left_ = fields.number<std::uint32_t>("chunk_count");
  }

  void open(const BagFields& fields, std::uint32_t data_bytes, BinaryStream& stream) {
    if (&stream != &file_) {
      stream.fail("a chunk within a chunk", "an undamaged bag");
    }
    --chunks_left_;
    chunk_ = open_chunk(file_, {.packing = fields.text("compression"),
                                .packed_bytes = data_bytes,
                                .unpacked_bytes = fields.number<std::uint32_t>("size")});
  }

  void read_connection(const BagFields& fields, const BagFields& details, const BinaryStream& stream) {
    const std::string type = details.text("type");
    const std::string sum = details.text("md5sum");
    const std::string topic = fields.text("topic");
    if (is_laser_scan(type) && sum != kLaserScanSum && sum != "*") {
      stream.fail(fmt::format("the messages of {} are of another definition of {}", printable(topic), type),
                  fmt::format("the one whose md5sum is {}", kLaserScanSum));
    }
    connections_[fields.number<std::uint32_t>("conn")] = topic_of(topic, type, is_laser_scan(type));
  }

  void read_message(BinaryStream& stream, const BagFields& fields, std::uint32_t data_bytes, Head& head) {
    const auto connection = connections_.find(fields.number<std::uint32_t>("conn"));
    if (connection == connections_.end()) {
      stream.fail("a message of no known connection", "an undamaged bag");
    }
    const auto time = fields.number<std::uint64_t>("time");  // seconds, and nanoseconds in the upper half
    constexpr std::int64_t kNsPerSecond = 1'000'000'000;
    head.topic = connection->second;
    head.recorded_ns =
        static_cast<std::int64_t>(time & 0xffffffffU) * kNsPerSecond + static_cast<std::int64_t>(time >> 32U);
    message_ = {};
    if (topics()[head.topic].has_scans) {
      message_ = stream.take(data_bytes);
    } else {
      stream.skip(data_bytes);
    }
  }

  void check_end() const {
    if (is_closed_ && chunks_left_ != 0) {
      file_.fail(fmt::format("the bag has {} chunks {} than it says", std::abs(chunks_left_),
                             chunks_left_ > 0 ? "fewer" : "more"),
                 "a whole bag (is it cut?)");
    }
  }

  BinaryStream file_;
  std::unique_ptr<BinaryStream> chunk_;
  std::map<std::uint32_t, std::size_t> connections_;
  std::string_view message_;
  bool is_closed_ = false;
  std::int64_t chunks_left_ = 0;
};

}  // namespace

bool is_ros_bag(std::string_view head) { return head.starts_with(kAnyMagic); }

std::unique_ptr<MessageLog> open_ros_bag(std::unique_ptr<ByteStream> bytes, const std::filesystem::path& path) {
  return std::make_unique<RosBag>(std::move(bytes), path.string());
}

}  // namespace odoless
