#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

/// How many executions a small program has, by the axioms of the memory model and trying all; slow and plain.
namespace odoless::model {

struct Operation {
  enum class Kind { kLoad, kStore, kExchange };
  Kind kind;
  std::size_t place;
  std::memory_order order;
};
/// Of each thread, what it does.
using Outline = std::vector<std::vector<Operation>>;
inline constexpr std::size_t kPlaces = 2;

[[nodiscard]] std::uint64_t count_by_axioms(const Outline& outline);

}  // namespace odoless::model
