#include "tools/emulate/cia402_pdo.hpp"

namespace odoless {
namespace {

using canopen::Object;

constexpr std::uint32_t kInvalidPdo = 1U << 31U;
constexpr std::uint32_t kIdMask = 0x7FF;
constexpr std::uint32_t kLastSyncType = 240;

struct Mapped {
  Object object;
  int size_bytes;
};

std::vector<Mapped> mapping_of(const ObjectDictionary& dictionary, std::uint16_t communication) {
  const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
  std::vector<Mapped> mapped;
  for (std::uint8_t sub = 1; sub <= dictionary.get({mapping, 0}); ++sub) {
    const std::uint32_t entry = dictionary.get({mapping, sub});
    mapped.push_back({{static_cast<std::uint16_t>(entry >> 16U), static_cast<std::uint8_t>(entry >> 8U)},
                      static_cast<int>((entry & 0xFFU) / 8)});
  }
  return mapped;
}

}  // namespace

std::optional<CanFrame> transmit_pdo(const ObjectDictionary& dictionary, int pdo) {
  const auto communication = static_cast<std::uint16_t>(0x1800 + pdo);
  const std::uint32_t cob = dictionary.get({communication, 1});
  const std::uint32_t type = dictionary.get({communication, 2});
  if ((cob & kInvalidPdo) != 0 || type == 0 || type > kLastSyncType) {
    return std::nullopt;
  }
  CanFrame frame;
  frame.id = cob & kIdMask;
  int at = 0;
  for (const Mapped& mapped : mapping_of(dictionary, communication)) {
    canopen::put(frame, at, dictionary.get(mapped.object), mapped.size_bytes);
    at += mapped.size_bytes;
  }
  frame.size_bytes = static_cast<std::uint8_t>(at);
  return frame;
}

std::vector<Object> take_received_pdo(ObjectDictionary& dictionary, int pdo, const CanFrame& frame) {
  const auto communication = static_cast<std::uint16_t>(0x1400 + pdo);
  const std::uint32_t cob = dictionary.get({communication, 1});
  std::vector<Object> written;
  if ((cob & kInvalidPdo) != 0 || (cob & kIdMask) != frame.id) {
    return written;
  }
  int at = 0;
  // All are written before any takes effect: the target, behind the control word, belongs to it.
  for (const Mapped& mapped : mapping_of(dictionary, communication)) {
    if (at + mapped.size_bytes > frame.size_bytes) {
      break;
    }
    dictionary.set(mapped.object, canopen::get(frame, at, mapped.size_bytes));
    written.push_back(mapped.object);
    at += mapped.size_bytes;
  }
  return written;
}

}  // namespace odoless
