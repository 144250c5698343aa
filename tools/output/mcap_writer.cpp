#include "tools/output/mcap_writer.hpp"

#include <fmt/core.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <bit>
#include <type_traits>

#include "core/base/check.hpp"
#include "tools/command/error.hpp"
#include "tools/log/formats/mcap_format.hpp"

namespace odoless {
namespace {

using namespace mcap;  // NOLINT(google-build-using-namespace)

constexpr std::string_view kPacking = "zstd";
constexpr int kZstdLevel = 3;

/// What a record holds, field by field.
class McapFields {
 public:
  template <class Number>
  McapFields& number(Number value) {
    static_assert(std::is_integral_v<Number> && std::endian::native == std::endian::little);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
    return *this;
  }
  /// With their number before them, as a text or a list has it.
  template <class Count = std::uint32_t>
  McapFields& counted(std::string_view bytes) {
    return number(static_cast<Count>(bytes.size())).plain(bytes);
  }
  McapFields& plain(std::string_view bytes) {
    bytes_ += bytes;
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string record(Op op, const McapFields& fields) {
  return McapFields().number(static_cast<std::uint8_t>(op)).counted<std::uint64_t>(fields.bytes()).bytes();
}

std::uint32_t crc32_of(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      ::crc32(before, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

std::string packed(std::string_view bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size_bytes = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), kZstdLevel);
  if (ZSTD_isError(size_bytes) != 0) {
    throw IoError(fmt::format("Zstandard: {}", ZSTD_getErrorName(size_bytes)));
  }
  out.resize(size_bytes);
  return out;
}

}  // namespace

void McapWriter::Span::include(std::uint64_t stamp_ns) {
  first_ns = std::min(first_ns, stamp_ns);
  last_ns = std::max(last_ns, stamp_ns);
}

std::array<std::uint64_t, 2> McapWriter::Span::ends() const { return {std::min(first_ns, last_ns), last_ns}; }

McapWriter::McapWriter(std::filesystem::path path) : file_(std::move(path)) {
  append(kMagic);
  append(record(kHeader, McapFields().counted("ros2").counted("odoless")));
}

std::uint16_t McapWriter::add_channel(std::string_view topic, std::string_view type, std::string_view definition) {
  const auto channel = static_cast<std::uint16_t>(messages_.size());
  const auto schema = static_cast<std::uint16_t>(channel + 1);  // 0 is none
  messages_.push_back(0);
  const std::string of_type =
      record(kSchema, McapFields().number(schema).counted(type).counted("ros2msg").counted(definition));
  const std::string of_topic =
      record(kChannel, McapFields().number(channel).number(schema).counted(topic).counted("cdr").counted(""));
  schemas_ += of_type;
  channels_ += of_topic;
  chunk_ += of_type + of_topic;
  return channel;
}

void McapWriter::write(std::uint16_t channel, std::int64_t stamp_ns, std::string_view message) {
  const auto time_ns = static_cast<std::uint64_t>(std::max<std::int64_t>(stamp_ns, 0));
  std::uint64_t& count = messages_.at(channel);
  chunk_index_[channel].emplace_back(time_ns, chunk_.size());
  chunk_ += record(kMessage, McapFields()
                                 .number(channel)
                                 .number(static_cast<std::uint32_t>(count++))
                                 .number(time_ns)
                                 .number(time_ns)
                                 .plain(message));
  chunk_span_.include(time_ns);
  span_.include(time_ns);
  if (chunk_.size() >= kChunk_bytes) {
    finish_chunk();
  }
}

void McapWriter::append(std::string_view bytes) {
  file_.append(bytes);
  crc32_ = crc32_of(bytes, crc32_);
  position_ += bytes.size();
}

void McapWriter::finish_chunk() {
  if (chunk_.empty()) {
    return;
  }
  const std::string inside = packed(chunk_);
  const auto [first_ns, last_ns] = chunk_span_.ends();
  const std::uint64_t begin = position_;
  append(record(kChunk, McapFields()
                            .number(first_ns)
                            .number(last_ns)
                            .number(std::uint64_t{chunk_.size()})
                            .number(crc32_of(chunk_))
                            .counted(kPacking)
                            .counted<std::uint64_t>(inside)));
  const std::uint64_t end = position_;
  McapFields places;
  for (const auto& [channel, messages] : chunk_index_) {
    McapFields list;
    for (const auto& [stamp_ns, place] : messages) {
      list.number(stamp_ns).number(place);
    }
    places.number(channel).number(position_);
    append(record(kMessageIndex, McapFields().number(channel).counted(list.bytes())));
  }
  chunk_indexes_ += record(kChunkIndex, McapFields()
                                            .number(first_ns)
                                            .number(last_ns)
                                            .number(begin)
                                            .number(end - begin)
                                            .counted(places.bytes())
                                            .number(position_ - end)
                                            .counted(kPacking)
                                            .number(std::uint64_t{inside.size()})
                                            .number(std::uint64_t{chunk_.size()}));
  ++chunks_;
  chunk_.clear();
  chunk_index_.clear();
  chunk_span_ = {};
}

std::string McapWriter::statistics() const {
  McapFields counts;
  std::uint64_t messages = 0;
  for (std::size_t channel = 0; channel < messages_.size(); ++channel) {
    messages += messages_[channel];
    counts.number(static_cast<std::uint16_t>(channel)).number(messages_[channel]);
  }
  const auto [first_ns, last_ns] = span_.ends();
  return record(kStatistics, McapFields()
                                 .number(messages)
                                 .number(static_cast<std::uint16_t>(messages_.size()))
                                 .number(static_cast<std::uint32_t>(messages_.size()))
                                 .number(std::uint32_t{0})  // attachments
                                 .number(std::uint32_t{0})  // metadata
                                 .number(chunks_)
                                 .number(first_ns)
                                 .number(last_ns)
                                 .counted(counts.bytes()));
}

/// From behind the end of the data to before the footer's checksum, which is over all of it.
std::string McapWriter::summary() const {
  const std::uint64_t begin = position_;
  std::string text;
  std::string offsets;
  const auto add = [&](Op op, const std::string& group) {
    if (!group.empty()) {
      offsets += record(kSummaryOffset, McapFields()
                                            .number(static_cast<std::uint8_t>(op))
                                            .number(begin + text.size())
                                            .number(std::uint64_t{group.size()}));
      text += group;
    }
  };
  add(kSchema, schemas_);
  add(kChannel, channels_);
  add(kStatistics, statistics());
  add(kChunkIndex, chunk_indexes_);
  const std::uint64_t offsets_begin = begin + text.size();
  text += offsets;
  constexpr std::uint64_t kFooter_bytes = 20;
  return text + McapFields()
                    .number(static_cast<std::uint8_t>(kFooter))
                    .number(kFooter_bytes)
                    .number(begin)
                    .number(offsets_begin)
                    .bytes();
}

void McapWriter::finish() {
  finish_chunk();
  append(record(kDataEnd, McapFields().number(crc32_)));
  const std::string end = summary();
  append(end);
  append(McapFields().number(crc32_of(end)).bytes());
  append(kMagic);
  file_.finish();
}

}  // namespace odoless
