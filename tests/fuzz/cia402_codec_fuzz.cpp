// CANopen: frames to checked answers, a drive's status to commands, and frames to lines of candump and back. Each 16
// bytes of the input are one frame; half of those with an odd first byte are answers to what is asked.
#include <array>
#include <cstring>

#include "drivers/io/candump_text.hpp"
#include "drivers/tilt/cia402/canopen.hpp"
#include "drivers/tilt/cia402/drive.hpp"
#include "drivers/tilt/cia402/sdo_client.hpp"
#include "tests/fuzz/codec_fuzz.hpp"
#include "tools/log/candump.hpp"

namespace {

using odoless::CanFrame;
namespace canopen = odoless::canopen;
namespace cia402 = odoless::cia402;

void check_answers(const CanFrame& frame, canopen::SdoClient& client, std::int64_t now_ns) {
  if (const auto error = canopen::emergency(frame); error.ok()) {
    ODOLESS_CHECK(error.value().code == canopen::get(frame, 0, 2));
  }
  if (const auto state = canopen::heartbeat_state(frame); state.ok()) {
    ODOLESS_CHECK(frame.size_bytes == 1);
  }
  const auto reply = canopen::sdo_reply(frame);
  if (!reply.ok()) {
    return;
  }
  ODOLESS_CHECK(reply.value().kind != canopen::SdoReply::Kind::kValue ||
                (reply.value().size_bytes >= 1 && reply.value().size_bytes <= 4));
  const bool was_busy = client.busy();
  const auto outcome = client.on_reply(reply.value());
  ODOLESS_CHECK(outcome == canopen::SdoClient::Outcome::kPending || (was_busy && !client.busy()));
  if (!client.busy()) {
    client.read(reply.value().object, now_ns);
  }
}

void check_text(const CanFrame& frame) {
  std::array<char, odoless::kCandumpTextMax> buffer{};
  const auto line = odoless::candump_text(1'700'000'000'123'456, "can0", frame, buffer);
  const auto again = odoless::parse_candump_line(line);
  ODOLESS_CHECK(again.has_value());
  CanFrame twice;
  twice = again->frame;
  std::array<char, odoless::kCandumpTextMax> other{};
  ODOLESS_CHECK(odoless::candump_text(1'700'000'000'123'456, "can0", twice, other) == line);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  odoless::test::FuzzInput input(data, size);
  cia402::Drive drive;
  canopen::SdoClient client(1, 1000);
  client.read({0x1000, 0}, 0);
  for (std::int64_t now_ns = 0; !input.empty(); now_ns += 100) {
    const auto bytes = input.take(sizeof(CanFrame));
    const auto frame = odoless::to_can_frame(std::as_bytes(bytes));
    if (!frame) {
      continue;
    }
    check_text(*frame);
    check_answers(*frame, client, now_ns);
    drive.on_status({.status_word = static_cast<std::uint16_t>(canopen::get(*frame, 0, 2)),
                     .mode = static_cast<std::int8_t>(frame->data[6])});
    const auto output = drive.next(static_cast<cia402::Drive::Goal>(frame->data[7] % 4U), frame->data[5]);
    ODOLESS_CHECK(drive.enabled() || (output.control_word & 0x10U) == 0);  // no set point but for an enabled drive
    if (client.busy() && now_ns >= client.deadline_ns()) {
      static_cast<void>(client.on_deadline(now_ns));
    }
    static_cast<void>(client.take_request());
  }
  static_cast<void>(odoless::parse_candump_line({reinterpret_cast<const char*>(data), size}));
  return 0;
}
