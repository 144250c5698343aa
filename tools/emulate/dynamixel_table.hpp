#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace odoless {

/// Errors of a status packet (e-Manual of Protocol 2.0, "Error").
enum class DynamixelError : std::uint8_t {
  kNone = 0,
  kResultFail = 1,
  kInstruction = 2,
  kCrc = 3,
  kDataRange = 4,   ///< outside of what the address can hold
  kDataLength = 5,  ///< a part of a value
  kDataLimit = 6,   ///< beyond another address's limit
  kAccess = 7,      ///< read only, not there, or kept and the torque is on
};

/// The control table of an emulated XM430-W350: what is where, as it is at first, and what may be written.
class DynamixelTable {
 public:
  static constexpr std::uint16_t kBytes = 252;
  static constexpr std::uint16_t kId = 7;
  static constexpr std::uint16_t kBaud = 8;
  static constexpr std::uint16_t kSecondaryId = 12;
  static constexpr std::uint16_t kFirstLost = 64;  ///< from here on it is not kept without power
  static constexpr std::uint16_t kRegistered = 69;
  static constexpr std::uint16_t kGoalVelocity = 104;
  static constexpr std::uint8_t kVelocityMode = 1;
  static constexpr std::uint8_t kExtendedPositionMode = 4;

  /// As it leaves the factory.
  DynamixelTable();
  /// What is lost without power is as at first.
  void power_up();

  [[nodiscard]] std::uint32_t get(std::uint16_t address, int size_bytes) const;
  [[nodiscard]] std::int32_t get_signed(std::uint16_t address) const {
    return static_cast<std::int32_t>(get(address, 4));
  }
  void set(std::uint16_t address, std::uint32_t value, int size_bytes);

  /// What a client reads, through the indirect addresses where it asks for those.
  [[nodiscard]] DynamixelError read(std::uint16_t first, std::uint16_t count, std::vector<std::uint8_t>& data) const;
  /// Whether that may be written; nothing is changed. Without limits for goals while their watchdog has tripped.
  [[nodiscard]] DynamixelError problem(std::uint16_t first, std::span<const std::uint8_t> data) const;
  /// To be called where there is no problem. @return the addresses written, where they are meant.
  std::vector<std::uint16_t> write(std::uint16_t first, std::span<const std::uint8_t> data);

 private:
  /// Where an address leads to: of the indirect data, elsewhere.
  [[nodiscard]] std::uint16_t meant(std::uint16_t address) const;
  [[nodiscard]] DynamixelError limit_problem(std::uint16_t address, std::int64_t value) const;

  std::array<std::uint8_t, kBytes> bytes_{};
};

}  // namespace odoless
