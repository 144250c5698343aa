#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"
#include "firmware/lcm/authentication.hpp"
#include "firmware/lcm/lcm_params.hpp"
#include "firmware/lcm/loss_counter.hpp"

namespace odoless {

/// A message on a channel that was asked for; a view, valid until the next call of the receiver.
struct LcmMessage {
  std::string_view channel{};
  std::span<const std::byte> payload{};
};

/// Since construction. Every datagram is counted in `datagrams` and in one of the six below it.
struct LcmReceiverCounters {
  std::int64_t datagrams = 0;
  std::int64_t messages = 0;        ///< given to the caller
  std::int64_t other_channels = 0;  ///< not asked for
  std::int64_t fragments = 0;       ///< pieces of messages longer than a datagram, which are not received here
  std::int64_t malformed = 0;       ///< not of LCM's form
  std::int64_t forged = 0;          ///< asked for, and not of who has the key
  std::int64_t replayed = 0;        ///< of who has the key, but taken before, out of order, or not sent just now
  std::int64_t lost = 0;            ///< as LossCounter has it, of any channel
  std::int64_t errors = 0;          ///< of the socket
};

/// Receives LCM messages that fit one datagram, by a socket of its own: liblcm's receiver trusts what a datagram says
/// about its size, this one trusts nothing. With `LcmParams::key_file` it gives messages of who has the key alone, each
/// once and in order, without their trailers.
///
/// Thread: one thread. Real time: after `open` no allocation and no lock; `try_receive` is one recv call per datagram
/// and does not wait, `receive` waits in ppoll.
class LcmReceiver {
 public:
  /// @param channels  Full names of those that are wanted.
  LcmReceiver(const LcmParams& params, std::vector<std::string> channels);
  ~LcmReceiver();
  LcmReceiver(const LcmReceiver&) = delete;
  LcmReceiver& operator=(const LcmReceiver&) = delete;

  /// Reads the key, if there is one, and joins the group; may be tried again. Errc::kBadAddress, also of the key's
  /// file, or Errc::kUnavailable; `reason` then says more.
  [[nodiscard]] Errc open();
  [[nodiscard]] const std::string& reason() const { return reason_; }

  /// The next message, waiting for at most `timeout_ns`; nothing if none came, or after an error of the socket.
  [[nodiscard]] std::optional<LcmMessage> receive(std::int64_t timeout_ns);
  /// The next message that is already here. Looks at `kDatagramsPerCall` at most, so that a flood of others cannot hold
  /// it: nothing does not mean that the socket is empty.
  [[nodiscard]] std::optional<LcmMessage> try_receive();
  static constexpr int kDatagramsPerCall = 64;

  /// Readable when a datagram is here, for somebody's own poll; -1 before `open`.
  [[nodiscard]] int descriptor() const { return descriptor_; }

  [[nodiscard]] const LcmReceiverCounters& counters() const { return counters_; }

 private:
  enum class Read { kMessage, kSkipped, kEmpty };
  [[nodiscard]] Errc fail(Errc error, std::string reason);
  [[nodiscard]] Read read_one(LcmMessage& message);
  [[nodiscard]] Read take(std::span<const std::byte> datagram, LcmMessage& message);
  [[nodiscard]] Errc prepare_key();
  [[nodiscard]] bool is_wanted(std::string_view channel) const;
  void close();

  std::string url_;
  std::string key_file_;
  std::vector<std::string> channels_;
  std::vector<std::byte> buffer_;
  std::string reason_;
  int descriptor_ = -1;
  LossCounter losses_;
  std::optional<MessageVerifier> verifier_;
  LcmReceiverCounters counters_;
};

}  // namespace odoless
