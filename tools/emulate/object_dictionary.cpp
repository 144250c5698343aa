#include "tools/emulate/object_dictionary.hpp"

#include <array>

namespace odoless {
namespace {

using canopen::Object;

constexpr std::uint32_t kReadOnlyAbort = 0x06010002U;
constexpr std::uint32_t kNoObject = 0x06020000U;
constexpr std::uint32_t kNotMappable = 0x06040041U;
constexpr std::uint32_t kPdoTooLong = 0x06040042U;
constexpr std::uint32_t kWrongLength = 0x06070010U;
constexpr std::uint32_t kNoSub = 0x06090011U;
constexpr std::uint32_t kOutOfRange = 0x06090030U;
constexpr std::uint32_t kNotInThisState = 0x08000022U;
constexpr std::uint32_t kUnknownCommand = 0x05040001U;
constexpr std::uint32_t kInvalidPdo = 1U << 31U;

std::uint32_t key(Object object) { return static_cast<std::uint32_t>(object.index) << 8U | object.sub; }

bool is_mapping(std::uint16_t index) {
  return (index >= 0x1600 && index < 0x1604) || (index >= 0x1A00 && index < 0x1A04);
}

constexpr std::uint8_t kMappedMax = 8;

/// What a drive's dictionary has besides its PDOs.
struct Row {
  Object object;
  std::uint32_t value;
  int size_bytes;
  ObjectDictionary::Access access;
};
constexpr auto kRead = ObjectDictionary::Access::kReadOnly;
constexpr auto kWrite = ObjectDictionary::Access::kReadWrite;
constexpr std::array kRows{
    Row{{0x1000, 0}, 0x00020192, 4, kRead},  // servo drive, 402
    Row{{0x1001, 0}, 0, 1, kRead},
    Row{{0x1005, 0}, 0x80, 4, kWrite},
    Row{{0x1016, 0}, 1, 1, kRead},
    Row{{0x1016, 1}, 0, 4, kWrite},
    Row{{0x1017, 0}, 0, 2, kWrite},
    Row{{0x1018, 0}, 1, 1, kRead},
    Row{{0x1018, 1}, 0x0D0, 4, kRead},
    Row{{0x6007, 0}, 1, 2, kWrite},
    Row{{0x603F, 0}, 0, 2, kRead},
    Row{{0x6040, 0}, 0, 2, kWrite},
    Row{{0x6041, 0}, 0, 2, kRead},
    Row{{0x605A, 0}, 2, 2, kWrite},
    Row{{0x6060, 0}, 0, 1, kWrite},
    Row{{0x6061, 0}, 0, 1, kRead},
    Row{{0x6064, 0}, 0, 4, kRead},
    Row{{0x606C, 0}, 0, 4, kRead},
    Row{{0x607A, 0}, 0, 4, kWrite},
    Row{{0x607D, 1}, 0x80000000U, 4, kWrite},
    Row{{0x607D, 2}, 0x7FFFFFFFU, 4, kWrite},
    Row{{0x6081, 0}, 10'000, 4, kWrite},
    Row{{0x6083, 0}, 10'000, 4, kWrite},
    Row{{0x6084, 0}, 10'000, 4, kWrite},
    Row{{0x6085, 0}, 10'000, 4, kWrite},
    Row{{0x6098, 0}, 0, 1, kWrite},
    Row{{0x6099, 1}, 1'000, 4, kWrite},
    Row{{0x6099, 2}, 100, 4, kWrite},
    Row{{0x609A, 0}, 10'000, 4, kWrite},
    Row{{0x60FF, 0}, 0, 4, kWrite},
};

}  // namespace

ObjectDictionary::ObjectDictionary(int node) : node_(node) {
  for (const Row& row : kRows) {
    add(row.object, row.value, row.size_bytes, row.access);
  }
  for (std::uint16_t pdo = 0; pdo < 4; ++pdo) {
    add_pdo(static_cast<std::uint16_t>(0x1400U + pdo), 0x200U + 0x100U * pdo);
    add_pdo(static_cast<std::uint16_t>(0x1800U + pdo), 0x180U + 0x100U * pdo);
    add({static_cast<std::uint16_t>(0x1800U + pdo), 5}, 0, 2, Access::kReadWrite);  // event timer: of sent ones alone
  }
}

void ObjectDictionary::reset_communication() {
  for (const auto& [at, entry] : ObjectDictionary(node_).entries_) {
    if (at < key({0x2000, 0})) {
      entries_[at] = entry;
    }
  }
}

void ObjectDictionary::add_pdo(std::uint16_t communication, std::uint32_t cob) {
  const bool is_first = (communication & 0xFFU) == 0;
  add({communication, 0}, 5, 1, Access::kReadOnly);
  add({communication, 1}, (cob + static_cast<std::uint32_t>(node_)) | (is_first ? 0U : kInvalidPdo), 4,
      Access::kReadWrite);
  add({communication, 2}, 0xFF, 1, Access::kReadWrite);
  add({communication, 3}, 0, 2, Access::kReadWrite);
  const auto mapping = static_cast<std::uint16_t>(communication + 0x200U);
  for (std::uint8_t sub = 0; sub <= kMappedMax; ++sub) {
    add({mapping, sub}, 0, sub == 0 ? 1 : 4, Access::kReadWrite);
  }
}

void ObjectDictionary::add(Object object, std::uint32_t value, int size_bytes, Access access) {
  entries_[key(object)] = {value, size_bytes, access};
}

std::uint32_t ObjectDictionary::get(Object object) const { return entries_.at(key(object)).value; }

std::int32_t ObjectDictionary::get_signed(Object object) const {
  const Entry& entry = entries_.at(key(object));
  const int unused_bits = 32 - 8 * entry.size_bytes;
  return static_cast<std::int32_t>(entry.value << unused_bits) >> unused_bits;
}

void ObjectDictionary::set(Object object, std::uint32_t value) { entries_.at(key(object)).value = value; }

int ObjectDictionary::size_bytes(Object object) const {
  const auto found = entries_.find(key(object));
  return found == entries_.end() ? 0 : found->second.size_bytes;
}

bool ObjectDictionary::pdo_is_valid(std::uint16_t mapping) const {
  return (get({static_cast<std::uint16_t>(mapping - 0x200), 1}) & kInvalidPdo) == 0;
}

// CiA 301, 7.5.2.36 and 7.5.2.38.
std::uint32_t ObjectDictionary::mapping_problem(Object object, std::uint32_t value) const {
  if (pdo_is_valid(object.index) || (object.sub > 0 && get({object.index, 0}) != 0)) {
    return kNotInThisState;
  }
  if (object.sub > 0) {
    const Object mapped{static_cast<std::uint16_t>(value >> 16U), static_cast<std::uint8_t>(value >> 8U)};
    const bool fits =
        value == 0 || (mapped.index >= 0x6000 && size_bytes(mapped) * 8 == static_cast<int>(value & 0xFFU));
    return fits ? 0 : kNotMappable;
  }
  if (value > kMappedMax) {
    return kOutOfRange;
  }
  std::uint32_t bits = 0;
  for (std::uint8_t sub = 1; sub <= value; ++sub) {
    bits += get({object.index, sub}) & 0xFFU;
  }
  return bits <= 64 ? 0 : kPdoTooLong;
}

std::uint32_t ObjectDictionary::write(Object object, std::uint32_t value, int size_bytes) {
  const auto found = entries_.find(key(object));
  if (found == entries_.end()) {
    const auto any_sub = entries_.lower_bound(key({object.index, 0}));
    return any_sub != entries_.end() && any_sub->first >> 8U == object.index ? kNoSub : kNoObject;
  }
  if (found->second.access == Access::kReadOnly) {
    return kReadOnlyAbort;
  }
  if (found->second.size_bytes != size_bytes) {
    return kWrongLength;
  }
  if (is_mapping(object.index)) {
    if (const std::uint32_t problem = mapping_problem(object, value); problem != 0) {
      return problem;
    }
  }
  found->second.value = value;
  return 0;
}

CanFrame ObjectDictionary::answer(const CanFrame& request, bool& written) {
  written = false;
  CanFrame reply = request;
  reply.id = canopen::kSdoReplyCob + static_cast<std::uint32_t>(node_);
  const Object object{static_cast<std::uint16_t>(canopen::get(request, 1, 2)), request.data[3]};
  const std::uint8_t command = request.data[0];
  std::uint32_t problem = 0;
  if (command == 0x40) {
    const auto found = entries_.find(key(object));
    problem = found == entries_.end() ? kNoObject : 0;
    if (problem == 0) {
      reply.data[0] = static_cast<std::uint8_t>(0x43U | static_cast<unsigned>(4 - found->second.size_bytes) << 2U);
      canopen::put(reply, 4, 0, 4);
      canopen::put(reply, 4, found->second.value, found->second.size_bytes);
    }
  } else if ((command & 0xF3U) == 0x23) {
    const int size_bytes = 4 - (command >> 2U & 3);
    problem = write(object, canopen::get(request, 4, size_bytes), size_bytes);
    written = problem == 0;
    reply.data[0] = 0x60;
    canopen::put(reply, 4, 0, 4);
  } else {
    problem = kUnknownCommand;
  }
  if (problem != 0) {
    reply.data[0] = 0x80;
    canopen::put(reply, 4, problem, 4);
  }
  return reply;
}

}  // namespace odoless
