#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "drivers/tilt/dynamixel/control_table.hpp"

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

/// A value of a control table.
struct DynamixelItem {
  std::uint16_t address = 0;
  int size_bytes = 0;
  std::int64_t first = 0;  ///< its value at first
  std::int64_t min = 0;    ///< more than `max`: it can only be read
  std::int64_t max = 0;
};

/// A model, by its e-Manual.
struct DynamixelModel {
  std::string_view name;
  dynamixel::ControlTable layout;
  std::span<const DynamixelItem> items;
  std::uint16_t indirect_end = 0;   ///< of the indirect addresses
  std::uint16_t indirect_data = 0;  ///< one byte for each of them, up to the table's end
  std::uint16_t bytes = 0;
};
[[nodiscard]] std::span<const DynamixelModel> dynamixel_models();
/// Null: none of that name.
[[nodiscard]] const DynamixelModel* find_dynamixel_model(std::string_view name);

/// The control table of an emulated servo: what is where, as it is at first, and what may be written. Addresses of
/// constants are those of the X series; `get` and `set` go to where the model has them.
class DynamixelTable {
 public:
  static constexpr std::uint16_t kId = 7;
  static constexpr std::uint16_t kBaud = 8;
  static constexpr std::uint16_t kSecondaryId = 12;
  static constexpr std::uint16_t kRegistered = 69;
  static constexpr std::uint16_t kGoalVelocity = 104;
  static constexpr std::uint8_t kVelocityMode = 1;
  static constexpr std::uint8_t kExtendedPositionMode = 4;

  /// As it leaves the factory.
  explicit DynamixelTable(const DynamixelModel& model);
  /// What is lost without power is as at first.
  void power_up();

  [[nodiscard]] const DynamixelModel& model() const { return *model_; }
  /// Whether what is at `address`, as clients say it, is lost without power.
  [[nodiscard]] bool is_lost(std::uint16_t address) const { return address >= model_->layout.first_lost; }

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
  [[nodiscard]] std::uint32_t load(std::uint16_t address, int size_bytes) const;
  void store(std::uint16_t address, std::uint32_t value, int size_bytes);
  [[nodiscard]] const DynamixelItem* item_at(std::uint16_t address) const;
  /// Where an address leads to: of the indirect data, elsewhere.
  [[nodiscard]] std::uint16_t meant(std::uint16_t address) const;
  [[nodiscard]] DynamixelError limit_problem(std::uint16_t address, std::int64_t value) const;

  const DynamixelModel* model_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace odoless
