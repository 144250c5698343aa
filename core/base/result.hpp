#pragma once

#include <utility>
#include <variant>

#include "core/base/check.hpp"

namespace odoless {

/// Reasons for a run-time failure in core, rt, drivers and firmware.
enum class Errc {
  kOk = 0,
  kTooManyBeams,   ///< a scan has more beams than the frame has room for
  kTooFewReturns,  ///< a scan has too few valid returns to be used
  kBadGeometry,    ///< angles or stamps that are not finite, or a step of zero
  kNoReference,    ///< a match was asked for before a reference was set
  kCapacity,       ///< a pool with a fixed capacity is full
  kBadAddress,     ///< an address or name that cannot be used
  kUnavailable,    ///< the network or a service of the system refuses
  kTooLong,        ///< a message is longer than allowed, or than the buffer
  kMalformed,      ///< a message doesn't follow its format
  kUnknownType,    ///< a message is of another type than expected
  kBadNumber,      ///< a number in a message is not finite, or out of its range
};

/// One sentence for a person.
[[nodiscard]] const char* describe(Errc error);

/// A value, or the reason why there is none.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}  // NOLINT(google-explicit-constructor): returned as a plain value
  Result(Errc error) : state_(error) { ODOLESS_CHECK(error != Errc::kOk); }  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return std::holds_alternative<T>(state_); }
  [[nodiscard]] Errc error() const { return ok() ? Errc::kOk : std::get<Errc>(state_); }
  [[nodiscard]] const T& value() const {
    ODOLESS_CHECK(ok());
    return *std::get_if<T>(&state_);
  }

 private:
  std::variant<T, Errc> state_;
};

}  // namespace odoless
