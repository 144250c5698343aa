#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

#include "tests/model/execution.hpp"

namespace odoless::model {

/// Who touched which words of 8 bytes of the memory that isn't atomic, and whether two did so in a race.
class PlainMemory {
 public:
  void clear() { words_.clear(); }

  /// Of a thread before its event `index`, which `before` happens before. False: that races with what another did.
  [[nodiscard]] bool touch(const void* begin, std::size_t size_bytes, bool writes, std::size_t thread,
                           const Clock& before) {
    bool is_ordered = true;
    const auto first = reinterpret_cast<std::uintptr_t>(begin) / kWord_bytes;
    const auto end = (reinterpret_cast<std::uintptr_t>(begin) + size_bytes + kWord_bytes - 1) / kWord_bytes;
    for (std::uintptr_t word = first; word < end; ++word) {
      is_ordered &= words_[word].touch(writes, thread, before);
    }
    return is_ordered;
  }

 private:
  static constexpr std::size_t kWord_bytes = 8;

  /// Of each thread, how many events it had before it did last; 0: it did not.
  class Word {
   public:
    bool touch(bool writes, std::size_t thread, const Clock& before) {
      bool is_ordered = are_before(written_, thread, before);
      if (writes) {
        is_ordered &= are_before(read_, thread, before);
        written_[thread] = before[thread] + 1U;
      } else {
        read_[thread] = before[thread] + 1U;
      }
      return is_ordered;
    }

   private:
    using Times = std::array<unsigned, kThreads>;
    static bool are_before(const Times& times, std::size_t thread, const Clock& before) {
      for (std::size_t other = 0; other < kThreads; ++other) {
        if (other != thread && times[other] > before[other]) {
          return false;
        }
      }
      return true;
    }
    Times written_{};
    Times read_{};
  };

  std::unordered_map<std::uintptr_t, Word> words_;
};

}  // namespace odoless::model
