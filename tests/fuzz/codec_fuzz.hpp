#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

#include "core/base/check.hpp"

/// What the codecs' fuzz programs share. A codec has no time and no device, so that millions of inputs a minute can be
/// tried; the programs without `_codec` try the whole sessions.
namespace odoless::test {

/// The fuzzer's input, taken from the front; beyond its end it is 0.
class FuzzInput {
 public:
  FuzzInput(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  [[nodiscard]] bool empty() const { return rest_.empty(); }
  [[nodiscard]] std::span<const std::uint8_t> take(std::size_t count) {
    const auto taken = rest_.first(std::min(count, rest_.size()));
    rest_ = rest_.subspan(taken.size());
    return taken;
  }
  [[nodiscard]] std::uint8_t byte() {
    const auto taken = take(1);
    return taken.empty() ? std::uint8_t{0} : taken[0];
  }
  /// A piece with its length, up to 255, before it.
  [[nodiscard]] std::span<const std::uint8_t> piece() { return take(byte()); }

 private:
  std::span<const std::uint8_t> rest_;
};

/// FNV-1a over what a reader has found.
class Digest {
 public:
  void add(std::span<const std::byte> bytes) {
    add_number(bytes.size());
    for (const std::byte byte : bytes) {
      hash_ = (hash_ ^ std::to_integer<std::uint64_t>(byte)) * 0x100000001b3U;
    }
  }
  void add(std::string_view text) { add(std::as_bytes(std::span(text.data(), text.size()))); }
  template <class Number>
  void add_number(Number number) {
    std::byte bytes[sizeof(Number)];
    std::memcpy(bytes, &number, sizeof(Number));
    for (const std::byte byte : bytes) {
      hash_ = (hash_ ^ std::to_integer<std::uint64_t>(byte)) * 0x100000001b3U;
    }
  }
  bool operator==(const Digest&) const = default;

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325U;
};

/// What `read(bytes, step)` finds is the same however the bytes are cut; it returns a Digest.
template <class Bytes, class Read>
void check_any_split(const Bytes& bytes, std::size_t step, const Read& read) {
  ODOLESS_CHECK(read(bytes, std::max<std::size_t>(bytes.size(), 1)) == read(bytes, std::max<std::size_t>(step, 1)));
}

/// Cuts `bytes` into pieces of `step` and lets `take(piece)` use each up; it returns false when it needs more.
template <class Bytes, class Take>
void feed(Bytes bytes, std::size_t step, const Take& take) {
  while (!bytes.empty()) {
    const std::size_t count = std::min(step, bytes.size());
    Bytes piece = bytes;
    if constexpr (requires { piece.substr(0, count); }) {
      piece = bytes.substr(0, count);
      bytes.remove_prefix(count);
    } else {
      piece = bytes.first(count);
      bytes = bytes.subspan(count);
    }
    std::size_t rounds_left = 2 * count + 4096;  // what was kept may be looked through again
    while (take(piece)) {
      ODOLESS_CHECK(--rounds_left > 0);
    }
    ODOLESS_CHECK(piece.empty());
  }
}

}  // namespace odoless::test
