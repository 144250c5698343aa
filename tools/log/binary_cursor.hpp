#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

namespace odoless {

/// Numbers and texts from the front of some bytes, and never beyond their end: then `ok` turns false, for good, and all
/// that is read is zero or empty.
class BinaryCursor {
 public:
  /// @param aligned  Each number stands at a multiple of its own size from the beginning, as in CDR.
  explicit BinaryCursor(std::string_view bytes, std::endian order = std::endian::little, bool aligned = false)
      : bytes_(bytes), order_(order), aligned_(aligned) {}

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::string_view rest() const { return bytes_.substr(at_); }

  std::string_view bytes(std::size_t size_bytes) {
    if (size_bytes > bytes_.size() - at_) {
      ok_ = false;
      at_ = bytes_.size();
      return {};
    }
    at_ += size_bytes;
    return bytes_.substr(at_ - size_bytes, size_bytes);
  }

  template <class Number>
  Number number() {
    if constexpr (std::is_same_v<Number, float>) {
      return std::bit_cast<float>(number<std::uint32_t>());
    } else if constexpr (std::is_same_v<Number, double>) {
      return std::bit_cast<double>(number<std::uint64_t>());
    } else {
      if (aligned_ && at_ % sizeof(Number) != 0) {
        bytes(sizeof(Number) - at_ % sizeof(Number));
      }
      return static_cast<Number>(value(bytes(sizeof(Number))));
    }
  }

  /// Letters, with their number in 32 bits before them.
  std::string_view text() { return bytes(number<std::uint32_t>()); }

 private:
  [[nodiscard]] std::uint64_t value(std::string_view digits) const {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < digits.size(); ++i) {
      const std::size_t place = order_ == std::endian::big ? i : digits.size() - 1 - i;
      value = value << 8U | static_cast<unsigned char>(digits[place]);
    }
    return value;
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
  std::endian order_;
  bool aligned_;
  bool ok_ = true;
};

}  // namespace odoless
