#pragma once

namespace odoless {

/// Asks its owner whether the time for a computation is over. The core knows no clock: a live thread passes one on its
/// own, replay passes none, so that no result depends on timing.
class Deadline {
 public:
  using Expired = bool (*)(const void* context);

  /// Never expires.
  Deadline() = default;
  Deadline(Expired is_over, const void* context) : expired_(is_over), context_(context) {}

  [[nodiscard]] bool expired() const { return expired_ != nullptr && expired_(context_); }

 private:
  Expired expired_ = nullptr;
  const void* context_ = nullptr;
};

}  // namespace odoless
