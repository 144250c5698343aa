#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

namespace odoless {

/// Bounded first-in first-out queue of records of any size and type, written and read in place.
///
/// Each record is a header of 8 bytes and its bytes, in one piece and on a multiple of 8. One that does not fit before
/// the end of the memory begins anew at its start, and the rest is skipped. Records of at most `max_record_bytes()`
/// always fit in an empty ring; larger ones are refused wherever the ring stands, so that luck never decides.
///
/// Thread:    one producer (`reserve`, `commit`), one consumer (`front`, `pop`); all counters from any thread.
/// Real time: wait-free on both sides, no system call; allocates in its constructor alone.
class RecordRing {
 public:
  struct Record {
    std::uint32_t type;
    std::span<const std::byte> bytes;
  };

  /// @param capacity_bytes  Rounded up to a multiple of 16 and to at least 32.
  explicit RecordRing(std::size_t capacity_bytes)
      : words_((capacity_bytes < 32 ? 32 : (capacity_bytes + 15) / 16 * 16) / kWord_bytes),
        bytes_(std::as_writable_bytes(std::span(words_))) {}

  RecordRing(const RecordRing&) = delete;
  RecordRing& operator=(const RecordRing&) = delete;
  RecordRing(RecordRing&&) = delete;
  RecordRing& operator=(RecordRing&&) = delete;
  ~RecordRing() = default;

  /// Room for one record, which the consumer sees after `commit`. A second `reserve` before that takes its place.
  ///
  /// @return  `size_bytes` bytes to be filled, on a multiple of 8; no bytes at a null pointer if there is no room,
  /// which
  ///          is counted. (A record of no bytes has a pointer.)
  [[nodiscard]] std::span<std::byte> reserve(std::uint32_t type, std::size_t size_bytes) {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    const std::size_t to_end_bytes = memory_bytes() - offset(tail);
    const std::size_t skipped_bytes = length_bytes(size_bytes) <= to_end_bytes ? 0 : to_end_bytes;
    // Acquire: of the release in `pop`.
    const std::uint64_t used_bytes = tail - head_.load(std::memory_order_acquire);
    if (size_bytes > max_record_bytes() || used_bytes + skipped_bytes + length_bytes(size_bytes) > memory_bytes()) {
      rejected_.store(rejected() + 1, std::memory_order_relaxed);
      return {};
    }
    if (skipped_bytes > 0) {
      write_header(tail, {kSkip, 0});
    }
    reserved_at_ = tail + skipped_bytes;
    reserved_ = {static_cast<std::uint32_t>(size_bytes), type};
    return bytes_.subspan(offset(reserved_at_) + kHeader_bytes, size_bytes);
  }

  /// Hands the reserved record over to the consumer.
  void commit() { commit(reserved_.size_bytes); }

  /// The same, with only the first `size_bytes` of what was reserved.
  void commit(std::size_t size_bytes) {
    reserved_.size_bytes = static_cast<std::uint32_t>(size_bytes);
    write_header(reserved_at_, reserved_);
    const std::uint64_t tail = reserved_at_ + length_bytes(size_bytes);
    // Release: after the record was written. The consumer would read bytes that are not yet written else.
    tail_.store(tail, std::memory_order_release);
    const std::size_t used_bytes = tail - head_.load(std::memory_order_relaxed);
    if (used_bytes > high_water_bytes_.load(std::memory_order_relaxed)) {
      high_water_bytes_.store(used_bytes, std::memory_order_relaxed);
    }
  }

  /// The oldest record, if there is one; its bytes stay until `pop`.
  [[nodiscard]] std::optional<Record> front() {
    const std::uint64_t tail = tail_.load(std::memory_order_acquire);  // of the release in `commit`
    std::uint64_t head = head_.load(std::memory_order_relaxed);
    if (head == tail) {
      return std::nullopt;
    }
    Header header = read_header(head);
    if (header.size_bytes == kSkip) {  // a record always follows
      head += memory_bytes() - offset(head);
      header = read_header(head);
    }
    front_end_ = head + length_bytes(header.size_bytes);
    return Record{header.type, bytes_.subspan(offset(head) + kHeader_bytes, header.size_bytes)};
  }

  /// Gives the room of the record of the last `front` back to the producer; only after a `front` that had one.
  void pop() {
    // Release: after the record was read. The producer would write over bytes that are still read else.
    head_.store(front_end_, std::memory_order_release);
  }

  /// Records refused since construction.
  [[nodiscard]] std::uint64_t rejected() const { return rejected_.load(std::memory_order_relaxed); }

  /// The most bytes, headers and skipped ends included, that were in use after a commit.
  [[nodiscard]] std::size_t high_water_bytes() const { return high_water_bytes_.load(std::memory_order_relaxed); }

  /// Size of the ring's memory.
  [[nodiscard]] std::size_t memory_bytes() const { return words_.size() * kWord_bytes; }

  [[nodiscard]] std::size_t max_record_bytes() const { return memory_bytes() / 2 - kHeader_bytes; }

 private:
  struct Header {
    std::uint32_t size_bytes;
    std::uint32_t type;
  };
  static constexpr std::size_t kWord_bytes = 8;
  static constexpr std::size_t kHeader_bytes = sizeof(Header);
  static constexpr std::uint32_t kSkip = 0xFFFFFFFF;  ///< as a size: go on at the start of the memory

  static std::size_t length_bytes(std::size_t size_bytes) {
    return kHeader_bytes + (size_bytes + kWord_bytes - 1) / kWord_bytes * kWord_bytes;
  }

  [[nodiscard]] std::size_t offset(std::uint64_t position) const { return position % memory_bytes(); }

  void write_header(std::uint64_t position, Header header) {
    std::memcpy(&bytes_[offset(position)], &header, sizeof(header));
  }

  [[nodiscard]] Header read_header(std::uint64_t position) const {
    Header header;
    std::memcpy(&header, &bytes_[offset(position)], sizeof(header));
    return header;
  }

  std::vector<std::uint64_t> words_;
  std::span<std::byte> bytes_;  ///< the same memory
  // Producer and consumer each write to a cache line of their own.
  alignas(64) std::atomic<std::uint64_t> tail_ = 0;  ///< bytes ever written, skipped ones included
  std::uint64_t reserved_at_ = 0;
  Header reserved_{};
  std::atomic<std::uint64_t> rejected_ = 0;
  std::atomic<std::size_t> high_water_bytes_ = 0;
  alignas(64) std::atomic<std::uint64_t> head_ = 0;  ///< bytes ever read, skipped ones included
  std::uint64_t front_end_ = 0;
};

}  // namespace odoless
