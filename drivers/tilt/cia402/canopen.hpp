#pragma once

#include <cstdint>

#include "core/base/result.hpp"
#include "drivers/io/can_frame.hpp"

/// CANopen's frames (CiA 301): what is sent and received, checked. All numbers are little-endian.
namespace odoless::canopen {

/// Base ids of the frames that a node sends or takes; its number is added.
enum Cob : std::uint32_t {
  kNmtCob = 0x000,
  kSyncCob = 0x080,
  kEmergencyCob = 0x080,
  kTransmitPdo1Cob = 0x180,
  kReceivePdo1Cob = 0x200,
  kTransmitPdo2Cob = 0x280,
  kSdoReplyCob = 0x580,
  kSdoRequestCob = 0x600,
  kHeartbeatCob = 0x700,
};

enum class NmtCommand : std::uint8_t {
  kStart = 0x01,
  kStop = 0x02,
  kPreOperational = 0x80,
  kResetNode = 0x81,
  kResetCommunication = 0x82,
};

enum class NodeState : std::uint8_t { kBootUp = 0x00, kStopped = 0x04, kOperational = 0x05, kPreOperational = 0x7F };

/// An entry of a node's object dictionary.
struct Object {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;

  bool operator==(const Object&) const = default;
};

/// A node's answer to an expedited SDO request.
struct SdoReply {
  enum class Kind : std::uint8_t { kValue, kWritten, kAbort };
  Kind kind = Kind::kAbort;
  Object object;
  std::uint32_t value = 0;  ///< of kValue, or the abort code
  int size_bytes = 0;       ///< of kValue: 1 to 4
};

struct Emergency {
  std::uint16_t code = 0;  ///< 0: the error is gone
  std::uint8_t error_register = 0;
};

inline constexpr std::uint32_t kAbortTimedOut = 0x05040000U;

[[nodiscard]] CanFrame nmt(NmtCommand command, int node);
[[nodiscard]] CanFrame sync();
[[nodiscard]] CanFrame heartbeat(int node, NodeState state);
[[nodiscard]] CanFrame sdo_read(int node, Object object);
/// @param size_bytes  1, 2 or 4.
[[nodiscard]] CanFrame sdo_write(int node, Object object, std::uint32_t value, int size_bytes);
[[nodiscard]] CanFrame sdo_abort(int node, Object object, std::uint32_t code);

/// Errors of these: Errc::kFrameMalformed.
[[nodiscard]] Result<SdoReply> sdo_reply(const CanFrame& frame);
[[nodiscard]] Result<Emergency> emergency(const CanFrame& frame);
[[nodiscard]] Result<NodeState> heartbeat_state(const CanFrame& frame);

/// `size_bytes` (1 to 4) of the data from `at` on.
[[nodiscard]] std::uint32_t get(const CanFrame& frame, int at, int size_bytes);
void put(CanFrame& frame, int at, std::uint32_t value, int size_bytes);

}  // namespace odoless::canopen
