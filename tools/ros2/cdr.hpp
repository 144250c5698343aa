#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace odoless::ros {

/// Messages to bytes as DDS has them: XCDR1, little end first. Each number stands at a multiple of its own size,
/// counted from behind the four bytes of the head.
class CdrWriter {
 public:
  /// Of a field, its name is not written.
  template <class Field>
  void operator()(const char*, const Field& field) {
    write(field);
  }

  template <class Message>
  [[nodiscard]] const std::string& encode(const Message& message) {
    bytes_.assign({'\0', '\1', '\0', '\0'});
    Message::describe(message, *this);
    return bytes_;
  }

 private:
  static constexpr std::size_t kHead_bytes = 4;

  template <class Field>
  void write(const Field& field) {
    if constexpr (std::is_arithmetic_v<Field>) {
      write_number(field);
    } else {
      Field::describe(field, *this);
    }
  }

  void write(const std::string& text) {
    write_number(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.append(text.c_str(), text.size() + 1);
  }

  template <class Element>
  void write(const std::vector<Element>& elements) {
    write_number(static_cast<std::uint32_t>(elements.size()));
    if constexpr (sizeof(Element) == 1) {
      bytes_.append(reinterpret_cast<const char*>(elements.data()), elements.size());
    } else {
      write_each(elements);
    }
  }

  template <class Element, std::size_t kSize>
  void write(const std::array<Element, kSize>& elements) {
    write_each(elements);
  }

  template <class Elements>
  void write_each(const Elements& elements) {
    for (const auto& element : elements) {
      write(element);
    }
  }

  template <class Number>
  void write_number(Number number) {
    static_assert(std::endian::native == std::endian::little);
    constexpr std::size_t kSize_bytes = sizeof(Number);
    bytes_.resize((bytes_.size() - kHead_bytes + kSize_bytes - 1) / kSize_bytes * kSize_bytes + kHead_bytes);
    bytes_.append(reinterpret_cast<const char*>(&number), kSize_bytes);
  }

  std::string bytes_;
};

}  // namespace odoless::ros
