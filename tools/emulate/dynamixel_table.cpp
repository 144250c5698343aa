#include "tools/emulate/dynamixel_table.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace odoless {
namespace {

using Item = DynamixelItem;

constexpr std::int64_t kTurns = 1'048'575;
constexpr std::array kItemsOfXm430{
    Item{0, 2, 1020, 1, 0},                 // model: XM430-W350
    Item{2, 4, 0, 1, 0},                    // model information
    Item{6, 1, 45, 1, 0},                   // firmware
    Item{7, 1, 1, 0, 252},                  // id
    Item{8, 1, 1, 0, 7},                    // baud rate
    Item{9, 1, 250, 0, 254},                // return delay
    Item{10, 1, 0, 0, 13},                  // drive mode
    Item{11, 1, 3, 0, 16},                  // operating mode
    Item{12, 1, 255, 0, 255},               // secondary id
    Item{13, 1, 2, 1, 2},                   // protocol
    Item{20, 4, 0, -1'044'479, 1'044'479},  // homing offset
    Item{24, 4, 10, 0, 1023},               // moving threshold
    Item{31, 1, 80, 0, 100},                // temperature limit
    Item{32, 2, 160, 95, 160},              // voltage limits
    Item{34, 2, 95, 95, 160},
    Item{36, 2, 885, 0, 885},    // PWM limit
    Item{38, 2, 1193, 0, 1193},  // current limit
    Item{44, 4, 200, 0, 1023},   // velocity limit
    Item{48, 4, 4095, 0, 4095},  // position limits
    Item{52, 4, 0, 0, 4095},
    Item{60, 1, 0, 0, 3},         // startup
    Item{63, 1, 52, 0, 63},       // shutdown
    Item{64, 1, 0, 0, 1},         // torque
    Item{65, 1, 0, 0, 1},         // LED
    Item{68, 1, 2, 0, 2},         // status return level
    Item{69, 1, 0, 1, 0},         // registered instruction
    Item{70, 1, 0, 1, 0},         // hardware error
    Item{76, 2, 1920, 0, 16383},  // gains
    Item{78, 2, 100, 0, 16383},
    Item{80, 2, 0, 0, 16383},
    Item{82, 2, 0, 0, 16383},
    Item{84, 2, 800, 0, 16383},
    Item{88, 2, 0, 0, 16383},
    Item{90, 2, 0, 0, 16383},
    Item{98, 1, 0, 0, 127},      // bus watchdog
    Item{100, 2, 0, -885, 885},  // goals
    Item{102, 2, 0, -1193, 1193},
    Item{104, 4, 0, -1023, 1023},
    Item{108, 4, 0, 0, 32767},  // profile
    Item{112, 4, 0, 0, 32767},
    Item{116, 4, 0, -kTurns, kTurns},
    Item{120, 2, 0, 1, 0},  // tick
    Item{122, 1, 0, 1, 0},  // moving
    Item{123, 1, 0, 1, 0},
    Item{124, 2, 0, 1, 0},  // present PWM, current, velocity, position
    Item{126, 2, 0, 1, 0},
    Item{128, 4, 0, 1, 0},
    Item{132, 4, 0, 1, 0},
    Item{136, 4, 0, 1, 0},  // trajectories
    Item{140, 4, 0, 1, 0},
    Item{144, 2, 120, 1, 0},  // voltage: 12.0 V
    Item{146, 1, 32, 1, 0},   // temperature: 32 deg C
    Item{147, 1, 0, 1, 0},    // backup
};

constexpr std::int64_t kFarthest = 2'147'483'647;
constexpr std::array kItemsOfPh54{
    Item{0, 2, 2020, 1, 0},                      // model: PH54-200-S500
    Item{2, 4, 0, 1, 0},                         // model information
    Item{6, 1, 12, 1, 0},                        // firmware
    Item{7, 1, 1, 0, 252},                       // id
    Item{8, 1, 1, 0, 7},                         // baud rate
    Item{9, 1, 250, 0, 254},                     // return delay
    Item{10, 1, 0, 0, 13},                       // drive mode
    Item{11, 1, 3, 0, 16},                       // operating mode
    Item{12, 1, 255, 0, 255},                    // secondary id
    Item{13, 1, 2, 1, 2},                        // protocol
    Item{20, 4, 0, -2'147'483'647, kFarthest},   // homing offset
    Item{24, 4, 20, 0, 2900},                    // moving threshold
    Item{31, 1, 80, 0, 100},                     // temperature limit
    Item{32, 2, 350, 150, 350},                  // voltage limits
    Item{34, 2, 150, 150, 350},                  //
    Item{36, 2, 2009, 0, 2009},                  // PWM limit
    Item{38, 2, 22740, 0, 22740},                // current limit
    Item{40, 4, 10765, 0, 10765},                // acceleration limit
    Item{44, 4, 2900, 0, 2900},                  // velocity limit
    Item{48, 4, 501'433, -501'923, 501'923},     // position limits
    Item{52, 4, -501'433, -501'923, 501'923},    //
    Item{56, 1, 0, 0, 3},                        // external ports
    Item{57, 1, 0, 0, 3},                        //
    Item{58, 1, 0, 0, 3},                        //
    Item{59, 1, 0, 0, 3},                        //
    Item{60, 1, 0, 0, 3},                        // startup
    Item{63, 1, 58, 0, 63},                      // shutdown
    Item{512, 1, 0, 0, 1},                       // torque
    Item{513, 1, 0, 0, 255},                     // LEDs
    Item{514, 1, 0, 0, 255},                     //
    Item{515, 1, 0, 0, 255},                     //
    Item{516, 1, 2, 0, 2},                       // status return level
    Item{517, 1, 0, 1, 0},                       // registered instruction
    Item{518, 1, 0, 1, 0},                       // hardware error
    Item{524, 2, 0, 0, 32767},                   // gains
    Item{526, 2, 0, 0, 32767},                   //
    Item{528, 2, 0, 0, 32767},                   //
    Item{530, 2, 0, 0, 32767},                   //
    Item{532, 2, 0, 0, 32767},                   //
    Item{536, 2, 0, 0, 32767},                   //
    Item{538, 2, 0, 0, 32767},                   //
    Item{546, 1, 0, 0, 127},                     // bus watchdog
    Item{548, 2, 0, -2009, 2009},                // goals
    Item{550, 2, 0, -22740, 22740},              //
    Item{552, 4, 0, -2900, 2900},                //
    Item{556, 4, 0, 0, kFarthest},               // profile
    Item{560, 4, 0, 0, kFarthest},               //
    Item{564, 4, 0, -2'147'483'647, kFarthest},  //
    Item{568, 2, 0, 1, 0},                       // tick
    Item{570, 1, 0, 1, 0},                       // moving
    Item{571, 1, 0, 1, 0},                       //
    Item{572, 2, 0, 1, 0},                       // present PWM, current, velocity, position
    Item{574, 2, 0, 1, 0},                       //
    Item{576, 4, 0, 1, 0},                       //
    Item{580, 4, 0, 1, 0},                       //
    Item{584, 4, 0, 1, 0},                       // trajectories
    Item{588, 4, 0, 1, 0},                       //
    Item{592, 2, 240, 1, 0},                     // voltage: 24.0 V
    Item{594, 1, 32, 1, 0},                      // temperature: 32 deg C
    Item{878, 1, 0, 1, 0},                       // backup
};

constexpr std::uint16_t kIndirectAddresses = 168;  ///< 2 bytes each, for one byte elsewhere
constexpr std::array<std::int64_t, 6> kOperatingModes{0, 1, 3, 4, 5, 16};
constexpr std::array kModels{DynamixelModel{.name = "xm430-w350",
                                            .layout = dynamixel::kTableOfX,
                                            .items = kItemsOfXm430,
                                            .indirect_end = 224,
                                            .indirect_data = 224,
                                            .bytes = 252},
                             DynamixelModel{.name = "ph54-200-s500",
                                            .layout = dynamixel::table_of_p(1'003'846.0),
                                            .items = kItemsOfPh54,
                                            .indirect_end = 424,
                                            .indirect_data = 634,
                                            .bytes = 880}};

/// The goals, and where their limits are; of the profile, where the model limits it.
struct Limit {
  std::uint16_t goal;
  std::uint16_t limit;
  int size_bytes;
  bool is_of_profile = false;
};
constexpr std::array<Limit, 5> kLimits{
    {{100, 36, 2}, {102, 38, 2}, {104, 44, 4}, {108, 40, 4, true}, {112, 44, 4, true}}};

std::int64_t value_of(const Item& item, std::span<const std::uint8_t> bytes) {
  std::uint32_t value = 0;
  for (int i = item.size_bytes - 1; i >= 0; --i) {
    value = value << 8U | bytes[static_cast<std::size_t>(i)];
  }
  const int unused_bits = 32 - 8 * item.size_bytes;
  return item.min < 0 && item.max > 0 ? static_cast<std::int32_t>(value << unused_bits) >> unused_bits
                                      : static_cast<std::int64_t>(value);
}

}  // namespace

std::span<const DynamixelModel> dynamixel_models() { return kModels; }

const DynamixelModel* find_dynamixel_model(std::string_view name) {
  const auto* const found = std::ranges::find(kModels, name, &DynamixelModel::name);
  return found == kModels.end() ? nullptr : found;
}

DynamixelTable::DynamixelTable(const DynamixelModel& model) : model_(&model), bytes_(model.bytes) {
  for (const Item& item : model.items) {
    store(item.address, static_cast<std::uint32_t>(item.first), item.size_bytes);
  }
  power_up();
}

void DynamixelTable::power_up() {
  for (const Item& item : model_->items) {
    if (is_lost(item.address)) {
      store(item.address, static_cast<std::uint32_t>(item.first), item.size_bytes);
    }
  }
  const int count =
      std::min<int>((model_->indirect_end - kIndirectAddresses) / 2, model_->bytes - model_->indirect_data);
  for (int i = 0; i < count; ++i) {
    store(static_cast<std::uint16_t>(kIndirectAddresses + 2 * i), static_cast<std::uint32_t>(model_->indirect_data + i),
          2);
    store(static_cast<std::uint16_t>(model_->indirect_data + i), 0, 1);
  }
}

std::uint32_t DynamixelTable::load(std::uint16_t address, int size_bytes) const {
  std::uint32_t value = 0;
  for (int i = size_bytes - 1; i >= 0; --i) {
    value = value << 8U | bytes_.at(address + static_cast<unsigned>(i));
  }
  return value;
}

void DynamixelTable::store(std::uint16_t address, std::uint32_t value, int size_bytes) {
  for (int i = 0; i < size_bytes; ++i, value >>= 8U) {
    bytes_.at(address + static_cast<unsigned>(i)) = static_cast<std::uint8_t>(value & 0xFFU);
  }
}

std::uint32_t DynamixelTable::get(std::uint16_t address, int size_bytes) const {
  return load(model_->layout.address(address), size_bytes);
}

void DynamixelTable::set(std::uint16_t address, std::uint32_t value, int size_bytes) {
  store(model_->layout.address(address), value, size_bytes);
}

const DynamixelItem* DynamixelTable::item_at(std::uint16_t address) const {
  const auto found = std::ranges::find_if(model_->items, [&](const Item& item) {
    return item.address <= address && address < item.address + item.size_bytes;
  });
  return found == model_->items.end() ? nullptr : &*found;
}

std::uint16_t DynamixelTable::meant(std::uint16_t address) const {
  const int nth = address - model_->indirect_data;
  const int at = kIndirectAddresses + 2 * nth;
  if (nth < 0 || at + 2 > model_->indirect_end) {
    return address;
  }
  const std::uint32_t there = load(static_cast<std::uint16_t>(at), 2);
  const bool is_indirect = there >= kIndirectAddresses && there < model_->indirect_end;
  return static_cast<std::uint16_t>(is_indirect || there >= model_->indirect_data || there >= model_->bytes ? address
                                                                                                            : there);
}

DynamixelError DynamixelTable::read(std::uint16_t first, std::uint16_t count, std::vector<std::uint8_t>& data) const {
  data.clear();
  if (count == 0 || first + count > model_->bytes) {
    return DynamixelError::kAccess;
  }
  for (std::uint16_t i = 0; i < count; ++i) {
    data.push_back(bytes_.at(meant(static_cast<std::uint16_t>(first + i))));
  }
  return DynamixelError::kNone;
}

DynamixelError DynamixelTable::limit_problem(std::uint16_t address, std::int64_t value) const {
  const dynamixel::ControlTable& layout = model_->layout;
  const std::uint32_t mode = get(dynamixel::kOperatingMode, 1);
  if (address == layout.address(dynamixel::kGoalPosition) && mode == dynamixel::kPositionControl) {
    const bool is_in = value >= get_signed(dynamixel::kPositionMin) && value <= get_signed(dynamixel::kPositionMax);
    return is_in ? DynamixelError::kNone : DynamixelError::kDataLimit;
  }
  const auto* const limit = std::ranges::find_if(kLimits, [&](const Limit& one) {
    return address == layout.address(one.goal) && (!one.is_of_profile || layout.limits_profile);
  });
  const bool is_in =
      limit == kLimits.end() || std::abs(value) <= static_cast<std::int64_t>(get(limit->limit, limit->size_bytes));
  return is_in ? DynamixelError::kNone : DynamixelError::kDataLimit;
}

DynamixelError DynamixelTable::problem(std::uint16_t first, std::span<const std::uint8_t> data) const {
  if (data.empty() || first + data.size() > model_->bytes) {
    return data.empty() ? DynamixelError::kDataLength : DynamixelError::kAccess;
  }
  const bool has_torque = get(dynamixel::kTorqueEnable, 1) != 0;
  for (std::size_t i = 0; i < data.size();) {
    const std::uint16_t address = meant(static_cast<std::uint16_t>(first + i));
    if (address >= kIndirectAddresses && address < model_->indirect_end) {
      ++i;
      continue;
    }
    const Item* const item = item_at(address);
    if (item == nullptr || item->min > item->max || (!is_lost(address) && has_torque)) {
      return DynamixelError::kAccess;
    }
    const auto size = static_cast<std::size_t>(item->size_bytes);
    if (address != item->address || i + size > data.size()) {
      return DynamixelError::kDataLength;
    }
    const std::int64_t value = value_of(*item, data.subspan(i, size));
    const bool is_mode =
        address != dynamixel::kOperatingMode || std::ranges::find(kOperatingModes, value) != kOperatingModes.end();
    if (value < item->min || value > item->max || !is_mode) {
      return DynamixelError::kDataRange;
    }
    if (const DynamixelError limit = limit_problem(address, value); limit != DynamixelError::kNone) {
      return limit;
    }
    i += size;
  }
  return DynamixelError::kNone;
}

std::vector<std::uint16_t> DynamixelTable::write(std::uint16_t first, std::span<const std::uint8_t> data) {
  std::vector<std::uint16_t> written;
  for (std::size_t i = 0; i < data.size(); ++i) {
    written.push_back(meant(static_cast<std::uint16_t>(first + i)));
    bytes_.at(written.back()) = data[i];
  }
  return written;
}

}  // namespace odoless
