#include "drivers/tilt/cia402/sdo_client.hpp"

#include <utility>

namespace odoless::canopen {

void SdoClient::ask(std::int64_t now_ns) {
  to_be_sent_ = true;
  deadline_ns_ = now_ns + timeout_ns_;
}

void SdoClient::read(Object object, std::int64_t now_ns) {
  object_ = object;
  writes_ = false;
  busy_ = true;
  tries_ = 1;
  ask(now_ns);
}

void SdoClient::write(Object object, std::uint32_t value, int size_bytes, std::int64_t now_ns) {
  read(object, now_ns);
  writes_ = true;
  value_ = value;
  size_bytes_ = size_bytes;
}

std::optional<CanFrame> SdoClient::take_request() {
  if (!busy_ || !std::exchange(to_be_sent_, false)) {
    return std::nullopt;
  }
  return writes_ ? sdo_write(node_, object_, value_, size_bytes_) : sdo_read(node_, object_);
}

SdoClient::Outcome SdoClient::on_reply(const SdoReply& reply) {
  const bool is_abort = reply.kind == SdoReply::Kind::kAbort;
  const bool is_mine = reply.object == object_ && (is_abort || (reply.kind == SdoReply::Kind::kWritten) == writes_);
  if (!busy_ || !is_mine) {
    return Outcome::kPending;
  }
  busy_ = false;
  if (is_abort || !writes_) {
    value_ = reply.value;
  }
  return is_abort ? Outcome::kAborted : Outcome::kDone;
}

SdoClient::Outcome SdoClient::on_deadline(std::int64_t now_ns) {
  if (tries_ >= kTries) {
    busy_ = false;
    return Outcome::kTimedOut;
  }
  ++tries_;
  ask(now_ns);
  return Outcome::kPending;
}

}  // namespace odoless::canopen
