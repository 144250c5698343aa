#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "drivers/lrf/sopas/telegram.hpp"

namespace odoless {

/// A telegram of any length that an emulated device writes.
class SopasWriter {
 public:
  /// @param head  Command and name: "sRA LMPscancfg".
  SopasWriter(sopas::Dialect dialect, std::string_view head) : dialect_(dialect), content_(head) {}

  SopasWriter& number(std::uint32_t value, int bytes);
  SopasWriter& signed_number(std::int32_t value) { return number(static_cast<std::uint32_t>(value), 4); }
  SopasWriter& real(float value);
  /// A name of fixed length.
  SopasWriter& word(std::string_view text);
  /// A text with its length before it.
  SopasWriter& text(std::string_view text);

  /// As it is sent.
  [[nodiscard]] std::string finish() const;

 private:
  void begin_value();

  sopas::Dialect dialect_;
  std::string content_;
  bool has_values_ = false;
};

}  // namespace odoless
