#pragma once

#include <cstdint>

namespace odoless::test {

inline constexpr std::int64_t kMs = 1'000'000;  // in nanoseconds
inline constexpr std::int64_t kSecond = 1'000'000'000;

}  // namespace odoless::test
