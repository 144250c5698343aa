#pragma once

#include <cstdint>
#include <map>

#include "drivers/io/can_frame.hpp"
#include "drivers/tilt/cia402/canopen.hpp"

namespace odoless {

/// The object dictionary of an emulated CANopen node, and its SDO server.
class ObjectDictionary {
 public:
  enum class Access : std::uint8_t { kReadOnly, kReadWrite };

  /// A 402 drive's, as it is after power-up.
  explicit ObjectDictionary(int node);

  /// What a reset of the communication does: its part (1000h to 1FFFh) is as after power-up.
  void reset_communication();
  void add(canopen::Object object, std::uint32_t value, int size_bytes, Access access);
  [[nodiscard]] std::uint32_t get(canopen::Object object) const;
  [[nodiscard]] std::int32_t get_signed(canopen::Object object) const;
  /// By the device itself.
  void set(canopen::Object object, std::uint32_t value);
  [[nodiscard]] int size_bytes(canopen::Object object) const;

  /// A write from outside. @return the abort code, or 0.
  [[nodiscard]] std::uint32_t write(canopen::Object object, std::uint32_t value, int size_bytes);

  /// The answer to an SDO request; `written` tells what a request has changed, if anything.
  [[nodiscard]] CanFrame answer(const CanFrame& request, bool& written);

 private:
  struct Entry {
    std::uint32_t value = 0;
    int size_bytes = 4;
    Access access = Access::kReadOnly;
  };

  /// Communication and mapping of a PDO.
  void add_pdo(std::uint16_t communication, std::uint32_t cob);
  [[nodiscard]] std::uint32_t mapping_problem(canopen::Object object, std::uint32_t value) const;
  [[nodiscard]] bool pdo_is_valid(std::uint16_t mapping) const;

  int node_;
  std::map<std::uint32_t, Entry> entries_;
};

}  // namespace odoless
