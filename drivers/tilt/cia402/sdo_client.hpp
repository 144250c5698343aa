#pragma once

#include <cstdint>
#include <optional>

#include "drivers/tilt/cia402/canopen.hpp"

namespace odoless::canopen {

/// Reads and writes one object of a node's dictionary at a time, by expedited transfer; a request without an answer is
/// repeated. Thread: one thread. Real time: no allocation.
class SdoClient {
 public:
  enum class Outcome : std::uint8_t {
    kPending,
    kDone,      ///< `value` holds what was read
    kAborted,   ///< the node refuses; `value` is the abort code
    kTimedOut,  ///< asked kTries times
  };

  SdoClient(int node, std::int64_t timeout_ns) : node_(node), timeout_ns_(timeout_ns) {}

  void read(Object object, std::int64_t now_ns);
  void write(Object object, std::uint32_t value, int size_bytes, std::int64_t now_ns);
  /// Forgets what is asked.
  void cancel() { busy_ = false; }

  [[nodiscard]] bool busy() const { return busy_; }
  [[nodiscard]] Object object() const { return object_; }
  [[nodiscard]] std::uint32_t value() const { return value_; }
  [[nodiscard]] std::int64_t deadline_ns() const { return deadline_ns_; }

  /// What is to be sent now, once.
  [[nodiscard]] std::optional<CanFrame> take_request();

  /// An answer of the node. What isn't the answer to this request leaves it pending.
  [[nodiscard]] Outcome on_reply(const SdoReply& reply);

  /// The deadline is over: asks again, or gives up.
  [[nodiscard]] Outcome on_deadline(std::int64_t now_ns);

 private:
  static constexpr int kTries = 3;

  void ask(std::int64_t now_ns);

  int node_;
  std::int64_t timeout_ns_;
  Object object_;
  bool busy_ = false;
  bool writes_ = false;
  bool to_be_sent_ = false;
  int size_bytes_ = 0;
  std::uint32_t value_ = 0;
  int tries_ = 0;
  std::int64_t deadline_ns_ = 0;
};

}  // namespace odoless::canopen
