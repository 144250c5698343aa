#include "tools/emulate/object_dictionary.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace odoless {
namespace {

using canopen::Object;

constexpr std::uint32_t kInvalidPdo = 1U << 31U;
constexpr std::uint32_t kNoRemoteRequest = 1U << 30U;
constexpr std::uint32_t kIdMask = 0x7FF;
constexpr std::uint32_t kDriveProfile = 0x6000;
constexpr std::uint8_t kMappedMax = 8;
constexpr Object kEmergencyId{0x1014, 0};

std::uint32_t key(Object object) { return static_cast<std::uint32_t>(object.index) << 8U | object.sub; }

bool is_one_of(std::uint16_t index, std::uint16_t first) {
  return index >= first && index < first + ObjectDictionary::kPdos;
}
bool is_mapping(std::uint16_t index) { return is_one_of(index, 0x1600) || is_one_of(index, 0x1A00); }
bool is_communication(std::uint16_t index) { return is_one_of(index, 0x1400) || is_one_of(index, 0x1800); }

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
    Row{{0x1003, 0}, 0, 1, kWrite},
    Row{{0x1003, 1}, 0, 4, kRead},
    Row{{0x1003, 2}, 0, 4, kRead},
    Row{{0x1003, 3}, 0, 4, kRead},
    Row{{0x1003, 4}, 0, 4, kRead},
    Row{{0x1005, 0}, 0x80, 4, kWrite},
    Row{{0x1016, 0}, 1, 1, kRead},
    Row{{0x1016, 1}, 0, 4, kWrite},
    Row{{0x1017, 0}, 0, 2, kWrite},
    Row{{0x1018, 0}, 4, 1, kRead},
    Row{{0x1018, 1}, 0x0D0, 4, kRead},
    Row{{0x1018, 2}, 402, 4, kRead},
    Row{{0x1018, 3}, 0x00010000, 4, kRead},
    Row{{0x1018, 4}, 1, 4, kRead},
    Row{{0x1029, 0}, 1, 1, kRead},
    Row{{0x1029, 1}, 0, 1, kWrite},
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
    Row{{0x607D, 0}, 2, 1, kRead},
    Row{{0x607D, 1}, 0x80000000U, 4, kWrite},
    Row{{0x607D, 2}, 0x7FFFFFFFU, 4, kWrite},
    Row{{0x6081, 0}, 10'000, 4, kWrite},
    Row{{0x6083, 0}, 10'000, 4, kWrite},
    Row{{0x6084, 0}, 10'000, 4, kWrite},
    Row{{0x6085, 0}, 10'000, 4, kWrite},
    Row{{0x6098, 0}, 0, 1, kWrite},
    Row{{0x6099, 0}, 2, 1, kRead},
    Row{{0x6099, 1}, 1'000, 4, kWrite},
    Row{{0x6099, 2}, 100, 4, kWrite},
    Row{{0x609A, 0}, 10'000, 4, kWrite},
    Row{{0x60C2, 0}, 2, 1, kRead},
    Row{{0x60C2, 1}, 10, 1, kWrite},
    Row{{0x60C2, 2}, 0xFD, 1, kWrite},  // 10^-3 s
    Row{{0x60FF, 0}, 0, 4, kWrite},
    Row{{0x6502, 0}, 1U << 0U | 1U << 5U | 1U << 7U, 4, kRead},  // profile position, homing, cyclic position
};

/// Longer than a frame: read by segments.
struct Name {
  Object object;
  std::string_view text;
};
constexpr std::array kNames{Name{{0x1008, 0}, "odoless emulated drive"}, Name{{0x1009, 0}, "none"},
                            Name{{0x100A, 0}, "1.0"}};

/// Objects that take these values alone.
struct Choice {
  Object object;
  std::span<const std::uint32_t> values;
};
constexpr std::array<std::uint32_t, 1> kClear{0};
constexpr std::array<std::uint32_t, 3> kErrorBehaviours{0, 1, 2};
constexpr std::array<std::uint32_t, 4> kAbortOptions{0, 1, 2, 3};
constexpr std::array<std::uint32_t, 7> kQuickStopOptions{0, 1, 2, 5, 6, 7, 8};
constexpr std::array<std::uint32_t, 4> kModes{0, 1, 6, 8};
constexpr std::array<Choice, 5> kChoices{{{{0x1003, 0}, kClear},
                                          {{0x1029, 1}, kErrorBehaviours},
                                          {{0x6007, 0}, kAbortOptions},
                                          {{0x605A, 0}, kQuickStopOptions},
                                          {{0x6060, 0}, kModes}}};

/// Ids that CiA 301 (7.3.5) keeps for others than PDOs, SYNC and emergencies.
bool is_restricted(std::uint32_t id) {
  return id < 0x80 || (id > 0x100 && id <= 0x180) || (id > 0x580 && id < 0x600) || (id > 0x600 && id <= 0x67F) ||
         id >= 0x6E0;
}

}  // namespace

ObjectDictionary::ObjectDictionary(int node) : node_(node) {
  for (const Row& row : kRows) {
    add(row.object, row.value, row.size_bytes, row.access);
  }
  add(kEmergencyId, 0x80U + static_cast<std::uint32_t>(node), 4, Access::kReadWrite);
  for (std::uint16_t pdo = 0; pdo < kPdos; ++pdo) {
    const auto sent = static_cast<std::uint16_t>(0x1800U + pdo);
    add_pdo(static_cast<std::uint16_t>(0x1400U + pdo), 0x200U + 0x100U * pdo, pdo == 0 ? 0x60400010U : 0U);
    add_pdo(sent, 0x180U + 0x100U * pdo, pdo == 0 ? 0x60410010U : 0U);
    add({sent, 5}, 0, 2, Access::kReadWrite);  // event timer: of sent ones alone
  }
}

void ObjectDictionary::reset_communication() {
  for (const auto& [at, entry] : ObjectDictionary(node_).entries_) {
    if (at < key({0x2000, 0})) {
      entries_[at] = entry;
    }
  }
}

void ObjectDictionary::add_pdo(std::uint16_t communication, std::uint32_t cob, std::uint32_t mapped) {
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
  set({mapping, 0}, mapped == 0 ? 0U : 1U);
  set({mapping, 1}, mapped);
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

bool ObjectDictionary::pdo_is_valid(std::uint16_t communication) const {
  return (get({communication, 1}) & kInvalidPdo) == 0;
}

std::uint32_t ObjectDictionary::missing(Object object) const {
  const auto any_sub = entries_.lower_bound(key({object.index, 0}));
  return any_sub != entries_.end() && any_sub->first >> 8U == object.index ? kNoSubAbort : kNoObjectAbort;
}

// CiA 301, 7.5.2.35 and 7.5.2.37: a PDO that is valid keeps its id and its inhibit time.
std::uint32_t ObjectDictionary::communication_problem(Object object, std::uint32_t value) const {
  const bool is_valid = pdo_is_valid(object.index);
  if (object.sub == 1) {
    const std::uint32_t id = value & kIdMask;
    const bool is_id = (value & ~(kInvalidPdo | kNoRemoteRequest | kIdMask)) == 0 && !is_restricted(id);
    const bool stays_valid = is_valid && (value & kInvalidPdo) == 0;
    return !is_id || (stays_valid && id != (get(object) & kIdMask)) ? kValueAbort : kNoAbort;
  }
  if (object.sub == 2) {
    return value > 240 && value < 254 ? kValueAbort : kNoAbort;  // reserved, or on remote requests
  }
  return object.sub == 3 && is_valid && value != get(object) ? kStateAbort : kNoAbort;
}

// CiA 301, 7.5.2.36 and 7.5.2.38.
std::uint32_t ObjectDictionary::mapping_problem(Object object, std::uint32_t value) const {
  if (pdo_is_valid(static_cast<std::uint16_t>(object.index - 0x200)) ||
      (object.sub > 0 && get({object.index, 0}) != 0)) {
    return kStateAbort;
  }
  if (object.sub > 0) {
    const Object mapped{static_cast<std::uint16_t>(value >> 16U), static_cast<std::uint8_t>(value >> 8U)};
    const auto found = entries_.find(key(mapped));
    const bool is_there = found != entries_.end() && mapped.index >= kDriveProfile &&
                          found->second.size_bytes * 8 == static_cast<int>(value & 0xFFU);
    const bool is_sent = object.index >= 0x1A00;
    const bool fits = is_there && (is_sent || found->second.access == Access::kReadWrite);
    return value == 0 || fits ? kNoAbort : kNotMappableAbort;
  }
  if (value > kMappedMax) {
    return kValueAbort;
  }
  std::uint32_t bits = 0;
  for (std::uint8_t sub = 1; sub <= value; ++sub) {
    const std::uint32_t entry = get({object.index, sub});
    bits += entry & 0xFFU;
    if (entry == 0) {
      return kNotMappableAbort;
    }
  }
  return bits <= 64 ? kNoAbort : kPdoTooLongAbort;
}

std::uint32_t ObjectDictionary::value_problem(Object object, std::uint32_t value) const {
  if (is_communication(object.index)) {
    return communication_problem(object, value);
  }
  if (is_mapping(object.index)) {
    return mapping_problem(object, value);
  }
  if (object == kEmergencyId) {
    const bool is_sent = ((value | get(object)) & kInvalidPdo) == 0;
    return is_sent && value != get(object) ? kValueAbort : kNoAbort;
  }
  const auto* const choice = std::ranges::find(kChoices, object, &Choice::object);
  const bool is_known = choice == kChoices.end() || std::ranges::find(choice->values, value) != choice->values.end();
  return is_known ? kNoAbort : kValueAbort;
}

std::uint32_t ObjectDictionary::write(Object object, std::string_view bytes) {
  if (std::ranges::find(kNames, object, &Name::object) != kNames.end()) {
    return kReadOnlyAbort;
  }
  const auto found = entries_.find(key(object));
  if (found == entries_.end()) {
    return missing(object);
  }
  if (found->second.access == Access::kReadOnly) {
    return kReadOnlyAbort;
  }
  const auto wished = static_cast<std::size_t>(found->second.size_bytes);
  if (bytes.size() != wished) {
    return bytes.size() > wished ? kTooLongAbort : kTooShortAbort;
  }
  std::uint32_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) {
    value = value << 8U | static_cast<unsigned char>(bytes[i]);
  }
  if (const std::uint32_t problem = value_problem(object, value); problem != kNoAbort) {
    return problem;
  }
  found->second.value = value;
  return kNoAbort;
}

std::uint32_t ObjectDictionary::read(Object object, std::string& bytes) const {
  if (const auto* const name = std::ranges::find(kNames, object, &Name::object); name != kNames.end()) {
    bytes = name->text;
    return kNoAbort;
  }
  const auto found = entries_.find(key(object));
  if (found == entries_.end()) {
    return missing(object);
  }
  bytes.clear();
  for (int i = 0; i < found->second.size_bytes; ++i) {
    bytes += static_cast<char>(found->second.value >> static_cast<unsigned>(8 * i));
  }
  return kNoAbort;
}

}  // namespace odoless
