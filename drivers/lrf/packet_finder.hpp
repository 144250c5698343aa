#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace odoless {

/// Finds packets in a stream of bytes. After damage it looks for the next start within what it has kept, so that no
/// other packet is lost.
///
/// `Format` says what packets look like: `kStart`, their first byte; `can_start(bytes)`, whether these may be the first
/// ones of a packet; `size_bytes(bytes)`, how many it has, as far as these tell: no fewer than must be there to tell
/// more; `decode(bytes)`, whether a whole one is right, of which it makes `packet()` then. Thread: one thread. Real
/// time: no allocation; time linear in the bytes, times `kBytesMax` where all are garbage.
template <class Format, std::size_t kBytesMax>
class PacketFinder {
 public:
  enum class Outcome : std::uint8_t {
    kMore,      ///< all bytes are used, and no packet is complete
    kPacket,    ///< `packet` holds one
    kSkipped,   ///< bytes are thrown away up to what looks like a start
    kWrongSum,  ///< what looked like a packet has the wrong sum, or holds what cannot be
  };

  /// Takes bytes off the front of `bytes` until something is found. Call until it says kMore.
  [[nodiscard]] Outcome take(std::span<const std::byte>& bytes) {
    for (;;) {
      if (!format_.can_start(kept())) {
        drop_to_next_start();
        if (!std::exchange(told_, true)) {
          return Outcome::kSkipped;
        }
      } else if (const std::size_t wanted = format_.size_bytes(kept()); wanted <= size_) {
        if (format_.decode(kept().first(wanted))) {
          drop(wanted);
          told_ = false;
          return Outcome::kPacket;
        }
        drop_to_next_start();
        told_ = true;
        return Outcome::kWrongSum;
      } else if (bytes.empty()) {
        return Outcome::kMore;
      } else {
        const std::size_t count = std::min(bytes.size(), wanted - size_);
        std::copy_n(bytes.begin(), count, buffer_.begin() + static_cast<std::ptrdiff_t>(size_));
        size_ += count;
        bytes = bytes.subspan(count);
      }
    }
  }

  [[nodiscard]] const auto& packet() const { return format_.packet(); }
  void clear() { size_ = 0; }

 private:
  [[nodiscard]] std::span<const std::byte> kept() const { return std::span(buffer_).first(size_); }

  void drop(std::size_t count) {
    const auto begin = buffer_.begin();
    std::copy(begin + static_cast<std::ptrdiff_t>(count), begin + static_cast<std::ptrdiff_t>(size_), begin);
    size_ -= count;
  }
  void drop_to_next_start() {
    const auto begin = buffer_.begin();
    const auto end = begin + static_cast<std::ptrdiff_t>(size_);
    drop(static_cast<std::size_t>(std::find(begin + 1, end, Format::kStart) - begin));
  }

  Format format_;
  std::array<std::byte, kBytesMax> buffer_{};
  std::size_t size_ = 0;
  bool told_ = false;  ///< that bytes are skipped, since the last packet
};

}  // namespace odoless
