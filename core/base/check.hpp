#pragma once

namespace odoless {

/// Prints the broken condition and aborts. Never returns.
[[noreturn]] void check_failed(const char* condition, const char* file, int line);

}  // namespace odoless

/// An always-on check: what fails it is a bug in the program, never bad input.
#define ODOLESS_CHECK(condition) \
  (static_cast<bool>(condition) ? static_cast<void>(0) : ::odoless::check_failed(#condition, __FILE__, __LINE__))
