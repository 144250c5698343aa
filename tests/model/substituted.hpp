#pragma once

// Of every header that is included after this one, std::atomic is the explorer's, and std::memcpy tells it what it
// touches. All of the standard library that those headers use comes first, and keeps its own. No other source of the
// program may include them, or it would have two of each.
#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tests/model/atomic.hpp"

namespace std {  // NOLINT(cert-dcl58-cpp): where the headers look
using odoless::model::copy_plain;
template <class T>
using explored_atomic = odoless::model::Atomic<T>;
}  // namespace std

#define atomic explored_atomic
#define memcpy copy_plain
