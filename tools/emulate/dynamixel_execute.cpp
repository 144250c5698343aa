#include <algorithm>
#include <array>
#include <utility>

#include "drivers/tilt/dynamixel/control_table.hpp"
#include "tools/emulate/dynamixel_device.hpp"

// What a Dynamixel does with each instruction of Protocol 2.0, and how it answers.
namespace odoless {
namespace {

constexpr int kAll = 0xFE;  ///< the id of every servo
constexpr std::size_t kBeforeInstruction = 7;

enum Instruction : std::uint8_t {
  kPing = 0x01,
  kRead = 0x02,
  kWrite = 0x03,
  kRegWrite = 0x04,
  kAction = 0x05,
  kFactoryReset = 0x06,
  kReboot = 0x08,
  kClear = 0x10,
  kStatus = 0x55,
  kSyncRead = 0x82,
  kSyncWrite = 0x83,
  kFastSyncRead = 0x8A,
  kBulkRead = 0x92,
  kBulkWrite = 0x93,
  kFastBulkRead = 0x9A,
};

std::uint16_t number_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] + 256 * bytes[at + 1]);
}

void put_sum(std::vector<std::uint8_t>& packet) {
  const std::uint16_t sum = dynamixel::crc16(packet);
  packet.push_back(static_cast<std::uint8_t>(sum & 0xFFU));
  packet.push_back(static_cast<std::uint8_t>(sum >> 8U));
}

/// From the header to the instruction; `length` counts from the instruction to the sum.
std::vector<std::uint8_t> head_of(int id, std::size_t length) {
  return {0xFF,
          0xFF,
          0xFD,
          0x00,
          static_cast<std::uint8_t>(id),
          static_cast<std::uint8_t>(length & 0xFFU),
          static_cast<std::uint8_t>(length >> 8U),
          kStatus};
}

/// Whether the last three bytes look like a header.
bool ends_like_header(std::span<const std::uint8_t> bytes) {
  constexpr std::array<std::uint8_t, 3> kHeader{0xFF, 0xFF, 0xFD};
  return bytes.size() >= 3 && std::ranges::equal(bytes.last(3), kHeader);
}

/// Instruction and parameters, with one byte more behind whatever looks like a header in them.
std::vector<std::uint8_t> stuffed(std::span<const std::uint8_t> parameters) {
  std::vector<std::uint8_t> bytes{kStatus};
  for (const std::uint8_t byte : parameters) {
    bytes.push_back(byte);
    if (ends_like_header(bytes)) {
      bytes.push_back(0xFD);
    }
  }
  return bytes;
}

/// A servo's place in a request to several, and what it is to read.
struct Share {
  std::size_t place = 0;
  std::size_t servos = 0;
  std::uint16_t address = 0;
  std::uint16_t count = 0;
  std::size_t bytes_of_all = 0;  ///< error, id, data and sum of each, for the fast reads
};

std::optional<Share> share_of(std::uint8_t instruction, std::span<const std::uint8_t> parameters, int id) {
  const bool is_sync = instruction == kSyncRead || instruction == kFastSyncRead;
  const std::size_t head = is_sync ? 4 : 0;
  const std::size_t each = is_sync ? 1 : 5;
  if (parameters.size() < head + each) {
    return std::nullopt;
  }
  std::optional<Share> share;
  std::size_t bytes_of_all = 0;
  std::size_t place = 0;
  for (std::size_t at = head; at + each <= parameters.size(); at += each, ++place) {
    const std::size_t what = is_sync ? 0 : at + 1;
    const std::uint16_t count = number_at(parameters, what + 2);
    bytes_of_all += count + 4U;
    if (parameters[at] == id && !share) {
      share = Share{.place = place, .address = number_at(parameters, what), .count = count};
    }
  }
  if (share) {
    share->servos = place;
    share->bytes_of_all = bytes_of_all;
  }
  return share;
}

}  // namespace

void DynamixelDevice::execute(const dynamixel::Packet& packet, std::int64_t now_ns) {
  const int second_id = static_cast<int>(table_.get(DynamixelTable::kSecondaryId, 1));
  const bool is_second = packet.id == second_id && packet.id < kAll - 1;
  const bool is_meant = packet.id == id() || packet.id == kAll || (is_second && packet.instruction != kPing);
  if (packet.instruction == kStatus || !is_meant) {
    return;
  }
  heard_s_ = now_s_;
  const std::span<const std::uint8_t> parameters = std::span(packet.parameters).first(packet.size);
  const Asked asked{.parameters = parameters, .id = packet.id, .now_ns = now_ns};
  if (packet.instruction >= kSyncRead) {
    execute_common(packet.instruction, asked);
  } else {
    execute_own(packet.instruction, asked);
  }
}

void DynamixelDevice::execute_own(std::uint8_t instruction, const Asked& asked) {
  switch (instruction) {
    case kPing: {
      const std::array<std::uint8_t, 3> model{static_cast<std::uint8_t>(table_.get(0, 1)),
                                              static_cast<std::uint8_t>(table_.get(1, 1)),
                                              static_cast<std::uint8_t>(table_.get(6, 1))};
      return answer(id(), DynamixelError::kNone, model, answer_due_ns(asked.now_ns));
    }
    case kRead:
      return read(asked);
    case kWrite: {
      const int level_before = level();
      const int id_before = id();
      const DynamixelError error = write(asked.parameters);
      if (level_before >= dynamixel::kAnswersAll && asked.id == id_before) {
        answer(id_before, error, {}, answer_due_ns(asked.now_ns));
      }
      return;
    }
    case kRegWrite:
      return acknowledge(register_write(asked.parameters), asked);
    case kAction:
      return acknowledge(do_registered(), asked);
    case kClear:
      return acknowledge(clear(asked.parameters), asked);
    case kReboot:
    case kFactoryReset: {
      const int old_id = id();
      const bool is_done =
          instruction == kReboot || (!asked.parameters.empty() && factory_reset(asked.parameters[0], asked.id == kAll));
      if (asked.id == old_id) {
        answer(old_id, is_done ? DynamixelError::kNone : DynamixelError::kDataRange, {}, asked.now_ns);
        output_.push_back(answers_.take_last());
      }
      if (is_done) {
        power_up(asked.now_ns);
      }
      return;
    }
    default:
      return acknowledge(DynamixelError::kInstruction, asked);
  }
}

void DynamixelDevice::execute_common(std::uint8_t instruction, const Asked& asked) {
  const bool is_known = instruction == kSyncRead || instruction == kFastSyncRead || instruction == kBulkRead ||
                        instruction == kFastBulkRead || instruction == kSyncWrite || instruction == kBulkWrite;
  if (asked.id != kAll || !is_known) {
    return acknowledge(DynamixelError::kInstruction, asked);
  }
  if (instruction == kSyncWrite || instruction == kBulkWrite) {
    write_common(instruction, asked);
  } else {
    read_common(instruction, asked);
  }
}

void DynamixelDevice::read(const Asked& asked) {
  if (asked.id != id() || level() < 1) {
    return;
  }
  refresh();
  std::vector<std::uint8_t> data;
  const bool is_whole = asked.parameters.size() == 4;
  const DynamixelError error = is_whole
                                   ? table_.read(number_at(asked.parameters, 0), number_at(asked.parameters, 2), data)
                                   : DynamixelError::kDataLength;
  answer(id(), error, data, answer_due_ns(asked.now_ns));
}

// Each servo answers after those before it in the list; of the fast reads all answers are one packet, to which each
// adds its part. Those before this one aren't there.
void DynamixelDevice::read_common(std::uint8_t instruction, const Asked& asked) {
  const std::optional<Share> share = share_of(instruction, asked.parameters, id());
  if (!share || level() < 1) {
    return;
  }
  refresh();
  std::vector<std::uint8_t> data;
  const DynamixelError error = table_.read(share->address, share->count, data);
  const std::int64_t due_ns =
      answer_due_ns(asked.now_ns) + static_cast<std::int64_t>(share->place) * options_.latency_ns;
  if (instruction == kSyncRead || instruction == kBulkRead) {
    return answer(id(), error, data, due_ns);
  }
  if (share->place > 0) {
    return;  // nobody has begun the packet
  }
  std::vector<std::uint8_t> packet = head_of(kAll, share->bytes_of_all + 1);
  packet.push_back(error_byte(error));
  packet.push_back(static_cast<std::uint8_t>(id()));
  data.resize(share->count);
  packet.insert(packet.end(), data.begin(), data.end());
  put_sum(packet);
  send_at(std::move(packet), due_ns);
}

void DynamixelDevice::write_common(std::uint8_t instruction, const Asked& asked) {
  const std::span<const std::uint8_t> all = asked.parameters;
  const bool is_sync = instruction == kSyncWrite;
  std::size_t at = is_sync ? 4 : 0;
  while (at + (is_sync ? 1U : 5U) <= all.size()) {
    const std::size_t what = is_sync ? 0 : at + 1;
    const std::size_t count = number_at(all, what + 2);
    const std::size_t data = at + (is_sync ? 1U : 5U);
    if (data + count > all.size()) {
      return;
    }
    if (all[at] == id()) {
      std::vector<std::uint8_t> wished{all[what], all[what + 1]};
      wished.insert(wished.end(), all.begin() + static_cast<std::ptrdiff_t>(data),
                    all.begin() + static_cast<std::ptrdiff_t>(data + count));
      static_cast<void>(write(wished));
      return;
    }
    at = data + count;
  }
}

void DynamixelDevice::acknowledge(DynamixelError error, const Asked& asked) {
  if (asked.id == id() && level() >= dynamixel::kAnswersAll) {
    answer(id(), error, {}, answer_due_ns(asked.now_ns));
  }
}

std::uint8_t DynamixelDevice::error_byte(DynamixelError error) const {
  const bool is_alert = table_.get(dynamixel::kHardwareError, 1) != 0;
  return static_cast<std::uint8_t>(static_cast<std::uint8_t>(error) | (is_alert ? dynamixel::kAlert : 0U));
}

std::int64_t DynamixelDevice::answer_due_ns(std::int64_t now_ns) const {
  return now_ns + options_.latency_ns + table_.get(dynamixel::kReturnDelay, 1) * std::int64_t{2000};
}

void DynamixelDevice::answer(int id, DynamixelError error, std::span<const std::uint8_t> data, std::int64_t due_ns) {
  std::vector<std::uint8_t> parameters{error_byte(error)};
  parameters.insert(parameters.end(), data.begin(), data.end());
  const std::vector<std::uint8_t> rest = stuffed(parameters);
  std::vector<std::uint8_t> packet = head_of(id, rest.size() + 2);
  packet.resize(kBeforeInstruction);
  packet.insert(packet.end(), rest.begin(), rest.end());
  put_sum(packet);
  send_at(std::move(packet), due_ns);
}

void DynamixelDevice::send_at(std::vector<std::uint8_t> packet, std::int64_t due_ns) {
  if (time_.fault(FaultKind::kWrongSum, last_tick_ns_) != nullptr) {
    packet.back() ^= 0x10U;
  }
  const std::span<const std::byte> bytes = std::as_bytes(std::span(packet));
  answers_.add({bytes.begin(), bytes.end()}, due_ns);
}

}  // namespace odoless
