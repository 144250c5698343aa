#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/output/whole_file.hpp"

namespace odoless {

/// An MCAP file of ROS 2's messages (CDR), in chunks packed by Zstandard, each with its index and checksum, and with
/// the summary by which a viewer finds its way without reading it all. It appears whole or not at all (WholeFile).
///
/// Memory: a chunk, the larger of `kChunk_bytes` and the longest message, and 16 bytes per message of it.
class McapWriter {
 public:
  static constexpr std::size_t kChunk_bytes = std::size_t{1} << 20;

  /// @throws CannotCreateError, as all that writes here throws IoError.
  explicit McapWriter(std::filesystem::path path);

  /// A channel of messages of one type. @param definition  Of the type, in the encoding ros2msg.
  /// @return  Its number for `write`.
  [[nodiscard]] std::uint16_t add_channel(std::string_view topic, std::string_view type, std::string_view definition);

  /// @param stamp_ns  0 or later; need not grow.
  void write(std::uint16_t channel, std::int64_t stamp_ns, std::string_view message);

  /// The last chunk, the summary and the end. Without it nothing is left of the file.
  void finish();

 private:
  /// When its first and last message were.
  struct Span {
    std::uint64_t first_ns = UINT64_MAX;
    std::uint64_t last_ns = 0;

    void include(std::uint64_t stamp_ns);
    /// 0 and 0 where there was none.
    [[nodiscard]] std::array<std::uint64_t, 2> ends() const;
  };
  using ChunkIndex = std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>>;

  void append(std::string_view bytes);
  void finish_chunk();
  [[nodiscard]] std::string summary() const;
  [[nodiscard]] std::string statistics() const;

  WholeFile file_;
  std::uint64_t position_ = 0;
  std::uint32_t crc32_ = 0;  ///< of all that is written
  std::string chunk_;
  ChunkIndex chunk_index_;  ///< stamp and place of each message in the chunk, by channel
  Span chunk_span_;
  std::string schemas_;  ///< these three: records as the summary repeats them
  std::string channels_;
  std::string chunk_indexes_;
  std::vector<std::uint64_t> messages_;  ///< by channel
  std::uint32_t chunks_ = 0;
  Span span_;
};

}  // namespace odoless
