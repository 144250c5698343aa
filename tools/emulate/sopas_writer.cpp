#include "tools/emulate/sopas_writer.hpp"

#include <fmt/format.h>

#include <bit>

namespace odoless {
namespace {

constexpr char kStx = '\x02';
constexpr char kEtx = '\x03';

std::string big_endian(std::uint32_t value, int bytes) {
  std::string text;
  for (int byte = bytes - 1; byte >= 0; --byte) {
    text += static_cast<char>(value >> (8U * static_cast<unsigned>(byte)));
  }
  return text;
}

}  // namespace

void SopasWriter::begin_value() {
  if (dialect_ == sopas::Dialect::kAscii || !has_values_) {
    content_ += ' ';
  }
  has_values_ = true;
}

SopasWriter& SopasWriter::number(std::uint32_t value, int bytes) {
  begin_value();
  content_ += dialect_ == sopas::Dialect::kAscii ? fmt::format("{:X}", value) : big_endian(value, bytes);
  return *this;
}

SopasWriter& SopasWriter::real(float value) {
  begin_value();
  const auto bits = std::bit_cast<std::uint32_t>(value);
  content_ += dialect_ == sopas::Dialect::kAscii ? fmt::format("{:08X}", bits) : big_endian(bits, 4);
  return *this;
}

SopasWriter& SopasWriter::word(std::string_view text) {
  begin_value();
  content_ += text;
  return *this;
}

SopasWriter& SopasWriter::text(std::string_view text) {
  number(static_cast<std::uint32_t>(text.size()), 2);
  return word(text);
}

std::string SopasWriter::finish() const {
  if (dialect_ == sopas::Dialect::kAscii) {
    return kStx + content_ + kEtx;
  }
  char sum = 0;
  for (const char c : content_) {
    sum = static_cast<char>(sum ^ c);
  }
  return std::string(4, kStx) + big_endian(static_cast<std::uint32_t>(content_.size()), 4) + content_ + sum;
}

}  // namespace odoless
