#pragma once

#include <span>

#include "drivers/io/device_address.hpp"
#include "drivers/lrf/lrf_params.hpp"

namespace odoless {

/// The line's rate, of a laser that cannot be told another: the one that is set, or one of the possible ones after the
/// other until the laser is found. At the far end of a network it is the server's.
class RateSearch {
 public:
  /// `rates_baud` must outlive it.
  RateSearch(const LrfParams& params, std::span<const int> rates_baud)
      : rates_baud_(params.baud == 0 && is_serial(params.device) ? rates_baud : std::span<const int>{}),
        baud_(rates_baud_.empty() ? params.baud : rates_baud_[0]) {}

  /// 0: whatever the line has.
  [[nodiscard]] int baud() const { return baud_; }

  /// Nobody answers at this one. @return  Whether all have been tried.
  bool next() {
    if (!rates_baud_.empty()) {
      tried_ = (tried_ + 1) % rates_baud_.size();
      baud_ = rates_baud_[tried_];
    }
    return tried_ == 0;
  }

  /// This is it; it stays.
  void found() {
    rates_baud_ = {};
    tried_ = 0;
  }

 private:
  std::span<const int> rates_baud_;
  std::size_t tried_ = 0;
  int baud_;
};

/// The line's rate, of a laser that can be told another: where nobody answers at the wished one, one of the possible
/// ones after the other, and the wished one again.
class SwitchedRate {
 public:
  /// @param wished_baud  0: none.
  /// @param rates_baud   Must outlive it. None: the rate stays, for it is not ours.
  SwitchedRate(int wished_baud, std::span<const int> rates_baud)
      : rates_baud_(rates_baud),
        wished_baud_(wished_baud),
        baud_(wished_baud == 0 && !rates_baud.empty() ? rates_baud[0] : wished_baud) {}

  [[nodiscard]] int baud() const { return baud_; }
  /// Whether another one is wished for.
  [[nodiscard]] bool is_another() const { return !rates_baud_.empty() && wished_baud_ != 0 && wished_baud_ != baud_; }

  /// Nobody answers at this one.
  void next() {
    if (rates_baud_.empty()) {
      return;
    }
    const bool is_round = tried_ == rates_baud_.size();
    baud_ = is_round && wished_baud_ != 0 ? wished_baud_ : rates_baud_[tried_ % rates_baud_.size()];
    tried_ = is_round ? 0 : tried_ + 1;
  }

  /// The device has the wished one now.
  void switch_over() { baud_ = wished_baud_; }

 private:
  std::span<const int> rates_baud_;
  std::size_t tried_ = 0;
  int wished_baud_;
  int baud_;
};

}  // namespace odoless
