#pragma once

#include <algorithm>
#include <cstdint>

namespace odoless {

/// Says when a laser that sends nothing is to be without power for a while. Pure: time comes in as stamps.
class LaserPower {
 public:
  /// @param now_ns  When it is switched on first.
  LaserPower(std::int64_t cycle_after_ns, std::int64_t off_ns, std::int64_t now_ns)
      : cycle_after_ns_(cycle_after_ns), off_ns_(off_ns), alive_ns_(now_ns) {}

  /// Whether it shall have power now. @param last_scan_ns  0: there was none.
  [[nodiscard]] bool update(std::int64_t now_ns, std::int64_t last_scan_ns) {
    if (off_until_ns_ != 0) {
      if (now_ns < off_until_ns_) {
        return false;
      }
      off_until_ns_ = 0;
      alive_ns_ = now_ns;  // it starts anew, which takes its time
      return true;
    }
    alive_ns_ = std::max(alive_ns_, last_scan_ns);
    if (now_ns - alive_ns_ < cycle_after_ns_) {
      return true;
    }
    off_until_ns_ = now_ns + off_ns_;
    ++cycles_;
    return false;
  }

  /// Times that it was switched off.
  [[nodiscard]] std::int64_t cycles() const { return cycles_; }

 private:
  std::int64_t cycle_after_ns_;
  std::int64_t off_ns_;
  std::int64_t alive_ns_;          ///< the last scan, or the last time that it was switched on
  std::int64_t off_until_ns_ = 0;  ///< 0: it is on
  std::int64_t cycles_ = 0;
};

}  // namespace odoless
