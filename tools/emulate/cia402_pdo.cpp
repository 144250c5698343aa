#include "tools/emulate/cia402_pdo.hpp"

#include <utility>

namespace odoless {
namespace {

using canopen::Object;

constexpr std::uint32_t kInvalidPdo = 1U << 31U;
constexpr std::uint32_t kIdMask = 0x7FF;
constexpr std::uint32_t kLastSyncType = 240;
constexpr double kInhibitUnitS = 1e-4;
constexpr double kEventTimerUnitS = 1e-3;

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

std::uint16_t received_at(std::uint16_t pdo) { return static_cast<std::uint16_t>(0x1400 + pdo); }
std::uint16_t sent_at(std::uint16_t pdo) { return static_cast<std::uint16_t>(0x1800 + pdo); }

}  // namespace

std::optional<CanFrame> ProcessData::content(std::uint16_t pdo) const {
  const std::uint32_t cob = dictionary_.get({sent_at(pdo), 1});
  const std::vector<Mapped> mapping = mapping_of(dictionary_, sent_at(pdo));
  if ((cob & kInvalidPdo) != 0 || mapping.empty()) {
    return std::nullopt;
  }
  CanFrame frame;
  frame.id = cob & kIdMask;
  int at = 0;
  for (const Mapped& mapped : mapping) {
    canopen::put(frame, at, dictionary_.get(mapped.object), mapped.size_bytes);
    at += mapped.size_bytes;
  }
  frame.size_bytes = static_cast<std::uint8_t>(at);
  return frame;
}

std::vector<CanFrame> ProcessData::at_sync() {
  std::vector<CanFrame> frames;
  for (std::uint16_t pdo = 0; pdo < ObjectDictionary::kPdos; ++pdo) {
    const std::uint32_t type = dictionary_.get({sent_at(pdo), 2});
    const std::optional<CanFrame> frame = content(pdo);
    Sent& sent = sent_.at(pdo);
    ++sent.syncs;
    const bool is_due = type == 0 ? frame != sent.frame : std::cmp_greater_equal(sent.syncs, type);
    if (frame && type <= kLastSyncType && is_due) {
      sent.syncs = 0;
      sent.frame = frame;
      frames.push_back(*frame);
    }
  }
  return frames;
}

std::vector<CanFrame> ProcessData::at_time(double now_s) {
  std::vector<CanFrame> frames;
  for (std::uint16_t pdo = 0; pdo < ObjectDictionary::kPdos; ++pdo) {
    const double inhibit_s = dictionary_.get({sent_at(pdo), 3}) * kInhibitUnitS;
    const double timer_s = dictionary_.get({sent_at(pdo), 5}) * kEventTimerUnitS;
    const std::optional<CanFrame> frame = content(pdo);
    Sent& sent = sent_.at(pdo);
    const double since_s = now_s - sent.time_s;
    const bool is_due = (frame != sent.frame && since_s >= inhibit_s) || (timer_s > 0.0 && since_s >= timer_s);
    if (frame && dictionary_.get({sent_at(pdo), 2}) > kLastSyncType && is_due) {
      sent.time_s = now_s;
      sent.frame = frame;
      frames.push_back(*frame);
    }
  }
  return frames;
}

std::vector<Object> ProcessData::take(std::uint16_t pdo, const CanFrame& frame) {
  std::vector<Object> written;
  int at = 0;
  // All are written before any takes effect: the target, behind the control word, belongs to it.
  for (const Mapped& mapped : mapping_of(dictionary_, received_at(pdo))) {
    dictionary_.set(mapped.object, canopen::get(frame, at, mapped.size_bytes));
    written.push_back(mapped.object);
    at += mapped.size_bytes;
  }
  return written;
}

std::vector<Object> ProcessData::receive(const CanFrame& frame) {
  std::vector<Object> written;
  for (std::uint16_t pdo = 0; pdo < ObjectDictionary::kPdos; ++pdo) {
    const std::uint32_t cob = dictionary_.get({received_at(pdo), 1});
    if ((cob & kInvalidPdo) != 0 || (cob & kIdMask) != frame.id) {
      continue;
    }
    int needed = 0;
    for (const Mapped& mapped : mapping_of(dictionary_, received_at(pdo))) {
      needed += mapped.size_bytes;
    }
    if (frame.size_bytes < needed) {
      was_too_short_ = true;
    } else if (dictionary_.get({received_at(pdo), 2}) <= kLastSyncType) {
      waiting_.at(pdo) = frame;
    } else {
      const std::vector<Object> taken = take(pdo, frame);
      written.insert(written.end(), taken.begin(), taken.end());
    }
  }
  return written;
}

bool ProcessData::was_too_short() { return std::exchange(was_too_short_, false); }

std::vector<Object> ProcessData::take_received() {
  std::vector<Object> written;
  for (std::uint16_t pdo = 0; pdo < ObjectDictionary::kPdos; ++pdo) {
    if (const std::optional<CanFrame> frame = std::exchange(waiting_.at(pdo), std::nullopt)) {
      const std::vector<Object> taken = take(pdo, *frame);
      written.insert(written.end(), taken.begin(), taken.end());
    }
  }
  return written;
}

}  // namespace odoless
