#include "tests/model/fiber.hpp"

#include <cstdint>
#include <utility>

namespace odoless::model {

void Fiber::start(std::function<void()> body) {
  body_ = std::move(body);
  stack_.resize(kStack_bytes);
  getcontext(&here_);
  here_.uc_stack.ss_sp = stack_.data();
  here_.uc_stack.ss_size = stack_.size();
  here_.uc_link = &outside_;
  const auto self = reinterpret_cast<std::uintptr_t>(this);  // makecontext passes integers on
  makecontext(&here_, reinterpret_cast<void (*)()>(&Fiber::enter), 2, static_cast<unsigned>(self >> 32),
              static_cast<unsigned>(self));
  has_ended_ = false;
}

void Fiber::enter(unsigned high, unsigned low) {
  auto* const self = reinterpret_cast<Fiber*>(std::uintptr_t{high} << 32 | low);
  self->body_();
  self->has_ended_ = true;
}

void Fiber::resume() { swapcontext(&outside_, &here_); }

void Fiber::yield() { swapcontext(&here_, &outside_); }

}  // namespace odoless::model
