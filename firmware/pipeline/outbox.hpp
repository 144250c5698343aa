#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "firmware/records/records.hpp"
#include "rt/record_ring.hpp"

namespace odoless {

/// What one real-time thread tells the publisher: records, each with the beams, bytes or cells that belong to it.
///
/// Thread: one writes, the publisher reads. Real time: writing is wait-free; what finds no room is counted by the ring.
class Outbox {
 public:
  explicit Outbox(std::size_t capacity_bytes) : ring_(capacity_bytes) {}

  /// @return false where there is no room.
  template <class Record, class Element = std::byte>
  bool send(RecordType type, const Record& record, std::span<const Element> elements = {}) {
    static_assert(std::is_trivially_copyable_v<Record> && std::is_trivially_copyable_v<Element>);
    const std::span<std::byte> room = reserve(type, sizeof(Record) + elements.size_bytes());
    if (room.empty()) {
      return false;
    }
    std::memcpy(room.data(), &record, sizeof(Record));
    if (!elements.empty()) {
      std::memcpy(room.data() + sizeof(Record), elements.data(), elements.size_bytes());
    }
    ring_.commit();
    return true;
  }

  /// Room to write a record in place, seen after `commit`; empty where there is none.
  [[nodiscard]] std::span<std::byte> reserve(RecordType type, std::size_t size_bytes) {
    return ring_.reserve(static_cast<std::uint32_t>(type), size_bytes);
  }
  void commit() { ring_.commit(); }
  /// With only the first `size_bytes` of it.
  void commit(std::size_t size_bytes) { ring_.commit(size_bytes); }

  [[nodiscard]] RecordRing& ring() { return ring_; }
  [[nodiscard]] const RecordRing& ring() const { return ring_; }

 private:
  RecordRing ring_;
};

/// A record's fixed part, copied out.
template <class Record>
[[nodiscard]] Record record_of(std::span<const std::byte> bytes) {
  Record record;
  std::memcpy(&record, bytes.data(), sizeof(Record));
  return record;
}

/// What follows it.
template <class Element, class Record>
[[nodiscard]] std::span<const Element> elements_of(std::span<const std::byte> bytes) {
  static_assert(sizeof(Record) % alignof(Element) == 0);
  const std::span<const std::byte> rest = bytes.subspan(sizeof(Record));
  return {reinterpret_cast<const Element*>(rest.data()), rest.size() / sizeof(Element)};
}

}  // namespace odoless
