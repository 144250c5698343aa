#pragma once

#include <cstddef>
#include <span>

namespace odoless {

/// Hears whether what comes is a laser's stream of packets: some in a row must make sense. `Reader`: a PacketFinder.
/// Thread: one thread. Real time: no allocation.
template <class Reader>
class PacketListener {
 public:
  void start() {
    packets_ = 0;
    reader_.clear();
  }

  /// Takes bytes off the front of `bytes`, all of them or until it is so.
  [[nodiscard]] bool hears(std::span<const std::byte>& bytes) {
    for (auto outcome = reader_.take(bytes); outcome != Reader::Outcome::kMore; outcome = reader_.take(bytes)) {
      packets_ = outcome == Reader::Outcome::kPacket ? packets_ + 1 : 0;
      if (packets_ == kPacketsWanted) {
        return true;
      }
    }
    return false;
  }
  /// The last one.
  [[nodiscard]] const auto& packet() const { return reader_.packet(); }

 private:
  static constexpr int kPacketsWanted = 4;

  Reader reader_;
  int packets_ = 0;
};

}  // namespace odoless
