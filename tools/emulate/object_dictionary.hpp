#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "drivers/tilt/cia402/canopen.hpp"

namespace odoless {

/// Abort codes of CiA 301 (7.2.4.3.17) that an emulated node gives.
enum SdoAbort : std::uint32_t {
  kNoAbort = 0,
  kToggleAbort = 0x05030000U,
  kCommandAbort = 0x05040001U,
  kReadOnlyAbort = 0x06010002U,
  kNoObjectAbort = 0x06020000U,
  kNotMappableAbort = 0x06040041U,
  kPdoTooLongAbort = 0x06040042U,
  kLengthAbort = 0x06070010U,
  kTooLongAbort = 0x06070012U,
  kTooShortAbort = 0x06070013U,
  kNoSubAbort = 0x06090011U,
  kValueAbort = 0x06090030U,
  kStateAbort = 0x08000022U,
};

/// The object dictionary of an emulated CANopen drive: numbers of 1, 2 or 4 bytes, and names.
class ObjectDictionary {
 public:
  enum class Access : std::uint8_t { kReadOnly, kReadWrite };

  static constexpr std::uint16_t kPdos = 4;  ///< each way

  /// A 402 drive's, as it is after power-up.
  explicit ObjectDictionary(int node);

  /// What a reset of the communication does: its part (1000h to 1FFFh) is as after power-up.
  void reset_communication();
  void add(canopen::Object object, std::uint32_t value, int size_bytes, Access access);
  [[nodiscard]] std::uint32_t get(canopen::Object object) const;
  [[nodiscard]] std::int32_t get_signed(canopen::Object object) const;
  /// By the device itself.
  void set(canopen::Object object, std::uint32_t value);
  /// Of a number; 0: there is none.
  [[nodiscard]] int size_bytes(canopen::Object object) const;

  /// A write from outside. @return the abort code, or 0.
  [[nodiscard]] std::uint32_t write(canopen::Object object, std::string_view bytes);
  /// What it is, lowest byte first. @return the abort code, or 0.
  [[nodiscard]] std::uint32_t read(canopen::Object object, std::string& bytes) const;

 private:
  struct Entry {
    std::uint32_t value = 0;
    int size_bytes = 4;
    Access access = Access::kReadOnly;
  };

  /// Communication and mapping of a PDO.
  void add_pdo(std::uint16_t communication, std::uint32_t cob, std::uint32_t mapped);
  [[nodiscard]] std::uint32_t missing(canopen::Object object) const;
  [[nodiscard]] std::uint32_t value_problem(canopen::Object object, std::uint32_t value) const;
  [[nodiscard]] std::uint32_t communication_problem(canopen::Object object, std::uint32_t value) const;
  [[nodiscard]] std::uint32_t mapping_problem(canopen::Object object, std::uint32_t value) const;
  [[nodiscard]] bool pdo_is_valid(std::uint16_t communication) const;

  int node_;
  std::map<std::uint32_t, Entry> entries_;
};

}  // namespace odoless
