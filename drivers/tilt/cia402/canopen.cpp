#include "drivers/tilt/cia402/canopen.hpp"

namespace odoless::canopen {
namespace {

// Command specifiers of the SDO protocol (CiA 301, 7.2.4.3).
constexpr std::uint8_t kReadRequest = 0x40;
constexpr std::uint8_t kWrittenReply = 0x60;
constexpr std::uint8_t kAbort = 0x80;
constexpr std::uint8_t kExpeditedUpload = 0x43;  ///< with a size; bits 2 and 3: how many of 4 bytes are unused
constexpr std::uint8_t kUnsizedUpload = 0x42;    ///< expedited, its size not told
constexpr std::uint8_t kExpeditedDownload = 0x23;

constexpr int kSdoBytes = 8;

CanFrame frame_of(std::uint32_t id, int size_bytes) {
  CanFrame frame;
  frame.id = id;
  frame.size_bytes = static_cast<std::uint8_t>(size_bytes);
  return frame;
}

CanFrame sdo_request(int node, std::uint8_t command, Object object, std::uint32_t value) {
  CanFrame frame = frame_of(kSdoRequestCob + static_cast<std::uint32_t>(node), kSdoBytes);
  frame.data[0] = command;
  put(frame, 1, object.index, 2);
  frame.data[3] = object.sub;
  put(frame, 4, value, 4);
  return frame;
}

std::uint8_t unused_bits(int size_bytes) { return static_cast<std::uint8_t>((4 - size_bytes) << 2); }

}  // namespace

std::uint32_t get(const CanFrame& frame, int at, int size_bytes) {
  std::uint32_t value = 0;
  for (int i = size_bytes - 1; i >= 0; --i) {
    value = value << 8U | frame.data[static_cast<std::size_t>(at) + static_cast<std::size_t>(i)];
  }
  return value;
}

void put(CanFrame& frame, int at, std::uint32_t value, int size_bytes) {
  for (int i = 0; i < size_bytes; ++i, value >>= 8U) {
    frame.data[static_cast<std::size_t>(at) + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(value);
  }
}

CanFrame nmt(NmtCommand command, int node) {
  CanFrame frame = frame_of(kNmtCob, 2);
  frame.data[0] = static_cast<std::uint8_t>(command);
  frame.data[1] = static_cast<std::uint8_t>(node);
  return frame;
}

CanFrame sync() { return frame_of(kSyncCob, 0); }

CanFrame heartbeat(int node, NodeState state) {
  CanFrame frame = frame_of(kHeartbeatCob + static_cast<std::uint32_t>(node), 1);
  frame.data[0] = static_cast<std::uint8_t>(state);
  return frame;
}

CanFrame sdo_read(int node, Object object) { return sdo_request(node, kReadRequest, object, 0); }

CanFrame sdo_write(int node, Object object, std::uint32_t value, int size_bytes) {
  return sdo_request(node, kExpeditedDownload | unused_bits(size_bytes), object, value);
}

CanFrame sdo_abort(int node, Object object, std::uint32_t code) { return sdo_request(node, kAbort, object, code); }

Result<SdoReply> sdo_reply(const CanFrame& frame) {
  if (frame.size_bytes != kSdoBytes) {
    return Errc::kFrameMalformed;
  }
  SdoReply reply;
  reply.object = {.index = static_cast<std::uint16_t>(get(frame, 1, 2)), .sub = frame.data[3]};
  const std::uint8_t command = frame.data[0];
  if (command == kAbort) {
    reply.value = get(frame, 4, 4);
    return reply;
  }
  if (command == kWrittenReply) {
    reply.kind = SdoReply::Kind::kWritten;
    return reply;
  }
  const bool sized = (command & 0xF3U) == kExpeditedUpload;
  if (!sized && command != kUnsizedUpload) {
    return Errc::kFrameMalformed;
  }
  reply.kind = SdoReply::Kind::kValue;
  reply.size_bytes = sized ? 4 - (command >> 2U & 3) : 4;
  reply.value = get(frame, 4, reply.size_bytes);
  return reply;
}

Result<Emergency> emergency(const CanFrame& frame) {
  if (frame.size_bytes != kSdoBytes) {
    return Errc::kFrameMalformed;
  }
  return Emergency{.code = static_cast<std::uint16_t>(get(frame, 0, 2)), .error_register = frame.data[2]};
}

Result<NodeState> heartbeat_state(const CanFrame& frame) {
  if (frame.size_bytes != 1) {
    return Errc::kFrameMalformed;
  }
  const auto state = static_cast<NodeState>(frame.data[0]);
  const bool known = state == NodeState::kBootUp || state == NodeState::kStopped || state == NodeState::kOperational ||
                     state == NodeState::kPreOperational;
  if (!known) {
    return Errc::kFrameMalformed;
  }
  return state;
}

}  // namespace odoless::canopen
