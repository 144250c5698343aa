#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>

namespace odoless {

/// Reads numbers in LCM's form, highest byte first, and never beyond the end: then `ok` turns false, for good, and all
/// that is read is zero or empty.
///
/// Real time: no allocation, no system call; each call is linear in what it reads.
class WireReader {
 public:
  explicit WireReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::span<const std::byte> rest() const { return rest_; }

  template <class Unsigned>
  Unsigned unsigned_number() {
    static_assert(std::is_unsigned_v<Unsigned>);
    Unsigned value = 0;
    for (const std::byte byte : bytes(sizeof(Unsigned))) {
      value = static_cast<Unsigned>((value << 8U) | std::to_integer<Unsigned>(byte));
    }
    return value;
  }

  std::int32_t int32() { return static_cast<std::int32_t>(unsigned_number<std::uint32_t>()); }
  std::int64_t int64() { return static_cast<std::int64_t>(unsigned_number<std::uint64_t>()); }
  float real32() { return std::bit_cast<float>(unsigned_number<std::uint32_t>()); }
  double real64() { return std::bit_cast<double>(unsigned_number<std::uint64_t>()); }

  void reals(std::span<double> out) {
    for (double& value : out) {
      value = real64();
    }
  }

  void skip(std::size_t size_bytes) { bytes(size_bytes); }

  /// A string: its size with the zero byte at its end, its letters, and that byte. One that has another zero byte
  /// inside is not ok.
  std::string_view text() {
    const auto size_bytes = unsigned_number<std::uint32_t>();
    const std::span<const std::byte> letters = bytes(size_bytes);
    const std::string_view read(reinterpret_cast<const char*>(letters.data()), letters.size());
    if (read.empty() || read.find('\0') != read.size() - 1) {
      fail();
      return {};
    }
    return read.substr(0, read.size() - 1);
  }

 private:
  void fail() {
    ok_ = false;
    rest_ = {};
  }

  std::span<const std::byte> bytes(std::size_t size_bytes) {
    if (size_bytes > rest_.size()) {
      fail();
      return {};
    }
    const std::span<const std::byte> taken = rest_.first(size_bytes);
    rest_ = rest_.subspan(size_bytes);
    return taken;
  }

  std::span<const std::byte> rest_;
  bool ok_ = true;
};

}  // namespace odoless
