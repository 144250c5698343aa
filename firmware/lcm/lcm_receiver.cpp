#include "firmware/lcm/lcm_receiver.hpp"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "firmware/lcm/datagram.hpp"
#include "firmware/lcm/udp_address.hpp"
#include "rt/cpu_clock.hpp"

namespace odoless {
namespace {

constexpr std::size_t kDatagramMaxBytes = 65'536;  // UDP has none longer
constexpr std::int64_t kNsPerS = 1'000'000'000;

bool set_option(int descriptor, int level, int option, int value) {
  return setsockopt(descriptor, level, option, &value, sizeof(value)) == 0;
}

// Beyond net.core.rmem_max where the process may; else up to it, without a word.
bool set_receive_buffer(int descriptor, int bytes) {
  return set_option(descriptor, SOL_SOCKET, SO_RCVBUFFORCE, bytes) ||
         set_option(descriptor, SOL_SOCKET, SO_RCVBUF, bytes);
}

// Several receivers on one host share the port.
bool share_port(int descriptor) {
  return set_option(descriptor, SOL_SOCKET, SO_REUSEADDR, 1) && set_option(descriptor, SOL_SOCKET, SO_REUSEPORT, 1);
}

bool bind_to(int descriptor, const MulticastAddress& address) {
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(address.port);
  place.sin_addr.s_addr = htonl(address.group);  // only what is sent to the group, not to the host
  return bind(descriptor, reinterpret_cast<const sockaddr*>(&place), sizeof(place)) == 0;
}

bool join(int descriptor, const MulticastAddress& address) {
  ip_mreq membership{};
  membership.imr_multiaddr.s_addr = htonl(address.group);
  membership.imr_interface.s_addr = htonl(INADDR_ANY);
  // Of all groups that others on this host have joined at this port, only ours.
  return set_option(descriptor, IPPROTO_IP, IP_MULTICAST_ALL, 0) &&
         setsockopt(descriptor, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof(membership)) == 0;
}

SenderKey key_of(const sockaddr_in& sender) {
  return (static_cast<SenderKey>(ntohl(sender.sin_addr.s_addr)) << 16U) | ntohs(sender.sin_port);
}

}  // namespace

LcmReceiver::LcmReceiver(const LcmParams& params, std::vector<std::string> channels)
    : url_(params.url), key_file_(params.key_file), channels_(std::move(channels)), buffer_(kDatagramMaxBytes) {}

LcmReceiver::~LcmReceiver() { close(); }

void LcmReceiver::close() {
  if (descriptor_ >= 0) {
    ::close(descriptor_);
    descriptor_ = -1;
  }
}

Errc LcmReceiver::fail(Errc error, std::string reason) {
  close();
  reason_ = std::move(reason);
  return error;
}

Errc LcmReceiver::prepare_key() {
  if (key_file_.empty() || verifier_) {
    return Errc::kOk;
  }
  std::string reason;
  const Result<LcmKey> key = read_key(key_file_, reason);
  if (!key.ok()) {
    return fail(key.error(), std::move(reason));
  }
  verifier_.emplace(key.value());
  return Errc::kOk;
}

Errc LcmReceiver::open() {
  close();
  const Result<MulticastAddress> address = parse_udp_address(url_);
  if (!address.ok()) {
    return fail(address.error(), "'" + url_ + "' is not of the form udpm://239.255.76.67:7667");
  }
  if (const Errc error = prepare_key(); error != Errc::kOk) {
    return error;
  }
  descriptor_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int buffer_bytes = address.value().receive_buffer_bytes;
  if (descriptor_ < 0 || !share_port(descriptor_) ||
      (buffer_bytes > 0 && !set_receive_buffer(descriptor_, buffer_bytes)) || !bind_to(descriptor_, address.value()) ||
      !join(descriptor_, address.value())) {
    const std::string why = std::generic_category().message(errno);
    return fail(Errc::kUnavailable,
                "cannot receive from '" + url_ + "': " + why +
                    "; does the host have a route for multicast (ip route add 224.0.0.0/4 dev lo)?");
  }
  return Errc::kOk;
}

bool LcmReceiver::is_wanted(std::string_view channel) const {
  return std::find(channels_.begin(), channels_.end(), channel) != channels_.end();
}

LcmReceiver::Read LcmReceiver::take(std::span<const std::byte> datagram, LcmMessage& message) {
  ++counters_.datagrams;
  const Result<Datagram> parsed = parse_datagram(datagram);
  if (!parsed.ok()) {
    ++(parsed.error() == Errc::kTooLong ? counters_.fragments : counters_.malformed);
    return Read::kSkipped;
  }
  if (!is_wanted(parsed.value().channel)) {
    ++counters_.other_channels;
    return Read::kSkipped;
  }
  message = {.channel = parsed.value().channel, .payload = parsed.value().payload};
  if (verifier_) {
    const auto verified = verifier_->verify(message.channel, message.payload, wall_clock_us());
    if (!verified.ok()) {
      ++(verified.error() == Errc::kTooOld ? counters_.replayed : counters_.forged);
      return Read::kSkipped;
    }
    message.payload = verified.value();
  }
  ++counters_.messages;
  return Read::kMessage;
}

LcmReceiver::Read LcmReceiver::read_one(LcmMessage& message) {
  sockaddr_in sender{};
  socklen_t sender_bytes = sizeof(sender);
  const ssize_t size_bytes = recvfrom(descriptor_, buffer_.data(), buffer_.size(), MSG_DONTWAIT,
                                      reinterpret_cast<sockaddr*>(&sender), &sender_bytes);
  if (size_bytes < 0) {
    if (errno == EINTR) {
      return Read::kSkipped;
    }
    counters_.errors += errno == EAGAIN ? 0 : 1;
    return Read::kEmpty;
  }
  const std::span<const std::byte> datagram(buffer_.data(), static_cast<std::size_t>(size_bytes));
  if (const Result<std::uint32_t> sequence = datagram_sequence(datagram); sequence.ok()) {
    losses_.note(key_of(sender), sequence.value());
    counters_.lost = losses_.lost();
  }
  return take(datagram, message);
}

std::optional<LcmMessage> LcmReceiver::try_receive() {
  LcmMessage message;
  for (int i = 0; descriptor_ >= 0 && i < kDatagramsPerCall; ++i) {
    switch (read_one(message)) {
      case Read::kMessage:
        return message;
      case Read::kEmpty:
        return std::nullopt;
      case Read::kSkipped:
        break;
    }
  }
  return std::nullopt;
}

std::optional<LcmMessage> LcmReceiver::receive(std::int64_t timeout_ns) {
  const std::int64_t deadline_ns = monotonic_ns() + timeout_ns;
  for (;;) {
    if (const std::optional<LcmMessage> message = try_receive()) {
      return message;
    }
    const std::int64_t left_ns = deadline_ns - monotonic_ns();
    if (descriptor_ < 0 || left_ns <= 0) {
      return std::nullopt;
    }
    pollfd readable{.fd = descriptor_, .events = POLLIN, .revents = 0};
    const timespec timeout{.tv_sec = left_ns / kNsPerS, .tv_nsec = left_ns % kNsPerS};
    if (ppoll(&readable, 1, &timeout, nullptr) < 0 && errno != EINTR) {
      ++counters_.errors;
      return std::nullopt;
    }
  }
}

}  // namespace odoless
