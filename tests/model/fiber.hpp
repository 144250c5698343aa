#pragma once

#include <ucontext.h>

#include <cstddef>
#include <functional>
#include <vector>

namespace odoless::model {

/// A function that can be left in its middle and gone on with, all on one thread of the system.
class Fiber {
 public:
  Fiber() = default;
  Fiber(const Fiber&) = delete;
  Fiber& operator=(const Fiber&) = delete;

  /// Anew; what was under way is forgotten where it stood.
  void start(std::function<void()> body);
  /// Runs until `yield` or the end. Not from within a fiber.
  void resume();
  /// Back to who resumed. From within.
  void yield();
  [[nodiscard]] bool has_ended() const { return has_ended_; }

 private:
  static constexpr std::size_t kStack_bytes = std::size_t{256} * 1024;
  static void enter(unsigned high, unsigned low);

  ucontext_t here_{};
  ucontext_t outside_{};
  std::vector<char> stack_;
  std::function<void()> body_;
  bool has_ended_ = true;
};

}  // namespace odoless::model
