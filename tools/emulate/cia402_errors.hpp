#pragma once

#include <cstdint>
#include <optional>

#include "drivers/io/can_frame.hpp"
#include "tools/emulate/object_dictionary.hpp"

namespace odoless {

/// Codes of emergency messages (CiA 301, 7.2.7.1) that an emulated node gives by itself.
enum EmergencyCode : std::uint16_t { kErrorsGone = 0x0000, kHeartbeatLost = 0x8130, kPdoTooShort = 0x8210 };

/// What an emulated node says of its errors: its emergency messages, error register (1001h) and history (1003h).
class NodeErrors {
 public:
  explicit NodeErrors(ObjectDictionary& dictionary) : dictionary_(dictionary) {}

  /// An error has come. @return the message, unless 1014h keeps it from being sent.
  [[nodiscard]] std::optional<CanFrame> raise(std::uint16_t code);
  /// All are gone. @return the message; nothing, too, where there was none.
  [[nodiscard]] std::optional<CanFrame> clear();

 private:
  [[nodiscard]] std::optional<CanFrame> message(std::uint16_t code) const;

  ObjectDictionary& dictionary_;
};

}  // namespace odoless
