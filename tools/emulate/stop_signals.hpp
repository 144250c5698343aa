#pragma once

#include <pthread.h>

#include <array>
#include <csignal>
#include <cstddef>

namespace odoless {

/// SIGTERM and SIGINT, blocked while this lives but for the time that `ppoll` waits with `mask`.
class StopSignals {
 public:
  StopSignals() {
    stopped_ = 0;
    struct sigaction action {};
    action.sa_handler = [](int) { stopped_ = 1; };
    sigset_t stops;
    sigemptyset(&stops);
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
      sigaddset(&stops, kSignals[i]);
      sigaction(kSignals[i], &action, &before_[i]);
    }
    pthread_sigmask(SIG_BLOCK, &stops, &mask_);
  }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  ~StopSignals() {
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
      sigaction(kSignals[i], &before_[i], nullptr);
    }
    pthread_sigmask(SIG_SETMASK, &mask_, nullptr);
  }

  [[nodiscard]] const sigset_t& mask() const { return mask_; }
  [[nodiscard]] static bool stopped() { return stopped_ != 0; }

 private:
  static constexpr std::array<int, 2> kSignals{SIGTERM, SIGINT};
  static inline volatile std::sig_atomic_t stopped_ = 0;
  std::array<struct sigaction, 2> before_{};
  sigset_t mask_{};
};

}  // namespace odoless
