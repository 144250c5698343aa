#include "firmware/sources/tilt_event_text.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "drivers/tilt/dynamixel/control_table.hpp"

namespace odoless {
namespace {

struct CodeText {
  std::int64_t code;
  EventText text;
};

/// Abort codes of CiA 301, 7.2.4.3.17; the number is the object.
constexpr std::array<CodeText, 21> kAbortTexts{{
    {0x05030000, "tilt servo: it refuses object {:06X}h: toggle bit not alternated"},
    {0x05040000, "tilt servo: it refuses object {:06X}h: timed out"},
    {0x05040001, "tilt servo: it refuses object {:06X}h: unknown command"},
    {0x06010000, "tilt servo: it refuses object {:06X}h: unsupported access"},
    {0x06010001, "tilt servo: it refuses object {:06X}h: it can only be written"},
    {0x06010002, "tilt servo: it refuses object {:06X}h: it can only be read"},
    {0x06020000, "tilt servo: it refuses object {:06X}h: it has no such object"},
    {0x06040041, "tilt servo: it refuses object {:06X}h: what it names cannot be mapped to a PDO"},
    {0x06040042, "tilt servo: it refuses object {:06X}h: the PDO would be too long"},
    {0x06040043, "tilt servo: it refuses object {:06X}h: it does not go with its other settings"},
    {0x06040047, "tilt servo: it refuses object {:06X}h: it does not go with itself"},
    {0x06060000, "tilt servo: it refuses object {:06X}h: hardware error"},
    {0x06070010, "tilt servo: it refuses object {:06X}h: wrong type or length"},
    {0x06090011, "tilt servo: it refuses object {:06X}h: it has no such sub-index"},
    {0x06090030, "tilt servo: it refuses object {:06X}h: the value is out of its range"},
    {0x06090031, "tilt servo: it refuses object {:06X}h: the value is too high"},
    {0x06090032, "tilt servo: it refuses object {:06X}h: the value is too low"},
    {0x08000000, "tilt servo: it refuses object {:06X}h: general error"},
    {0x08000020, "tilt servo: it refuses object {:06X}h: it cannot store it"},
    {0x08000021, "tilt servo: it refuses object {:06X}h: it is under local control"},
    {0x08000022, "tilt servo: it refuses object {:06X}h: not in its present state"},
}};

constexpr std::array<std::int64_t, 3> kRangeAborts{0x06090030, 0x06090031, 0x06090032};

/// What follows from [tilt] directly; all other values are the same for every drive.
constexpr std::array<std::uint32_t, 9> kConfiguredObjects{0x608100, 0x608300, 0x608400, 0x608500, 0x609800,
                                                          0x609901, 0x609902, 0x609A00, 0x60FF00};

constexpr EventText kOutOfRangeOfTilt =
    "tilt servo: it refuses object {:06X}h: the value is out of its range (tilt.speed_degps, "
    "tilt.acceleration_degps2, tilt.homing_*, tilt.counts_per_turn, tilt.speed_units_per_count: what can it do?)";

constexpr std::array<EventText, kTiltLacks> kLackTexts{
    "tilt servo: it cannot watch the daemon (it refuses 1016h): should the daemon die, it ends the move that it is at",
    "tilt servo: it takes no quick stop for when the daemon is lost (it refuses 6007h): what it does then is of its "
    "own settings",
    "tilt servo: it does not hold after a stop (it refuses 605Ah): without a brake the laser may sink then",
    "tilt servo: it keeps no limits by itself (it refuses 607Dh): only the daemon does",
    "tilt servo: it sends no heartbeat (it refuses 1017h): its answers to SYNC alone tell that it lives",
    "tilt servo: it tells where it was sent, not where it is: that it is blocked or pushed away is not seen, and "
    "should "
    "the daemon die, it ends the move that it is at"};

/// Errors of a status packet, e-Manual of Protocol 2.0, 5.3; the number is the address.
constexpr std::array<CodeText, 7> kErrorNumberTexts{{
    {1, "tilt servo: it failed to do what it was asked at address {}"},
    {2, "tilt servo: it does not know an instruction (address {})"},
    {3, "tilt servo: what it was asked at address {} came with a wrong check sum"},
    {4, "tilt servo: it refuses address {}: the value is out of its range (does [tilt] ask too much of it?)"},
    {5, "tilt servo: it refuses address {}: wrong length (is it a servo of the X or P series?)"},
    {6, "tilt servo: it refuses address {}: the value is beyond its own limits (does [tilt] ask too much of it?)"},
    {7, "tilt servo: it refuses address {}: it can only be read, or not be written with torque on"},
}};

const CodeText* find(std::span<const CodeText> texts, std::int64_t code) {
  const auto found = std::ranges::find(texts, code, &CodeText::code);
  return found == texts.end() ? nullptr : &*found;
}

/// Of something that the servo refuses.
TiltEventText refusal_text(const CodeText* known, const TiltEvent& event, EventText otherwise) {
  constexpr int kCodeBits = 32;
  return known != nullptr
             ? TiltEventText{EventPriority::kError, known->text, event.object}
             : TiltEventText{EventPriority::kError, otherwise, std::int64_t{event.object} << kCodeBits | event.code};
}

bool is_range_of_tilt(const TiltEvent& event) {
  return std::ranges::find(kRangeAborts, event.code) != kRangeAborts.end() &&
         std::ranges::find(kConfiguredObjects, event.object) != kConfiguredObjects.end();
}

TiltEventText error_text(const TiltEvent& event) {
  switch (event.error) {
    case TiltError::kAbort:
      if (is_range_of_tilt(event)) {
        return {EventPriority::kError, kOutOfRangeOfTilt, event.object};
      }
      return refusal_text(find(kAbortTexts, event.code), event,
                          "tilt servo: it refuses an object: {:014X}h (index, sub-index, abort code)");
    case TiltError::kErrorNumber:
      return refusal_text(find(kErrorNumberTexts, event.code & dynamixel::kErrorNumber), event,
                          "tilt servo: it refuses what it was asked: {:012X}h (address, error)");
    case TiltError::kEmergency:
      return {EventPriority::kError, "tilt servo: emergency, error code {:04X}h (see the drive's manual)", event.code};
    case TiltError::kFault:
      return event.code < 0 ? TiltEventText{EventPriority::kError, "tilt servo: it has a fault and does not say which"}
                            : TiltEventText{EventPriority::kError,
                                            "tilt servo: it has a fault, error code {:04X}h (see the "
                                            "drive's manual)",
                                            event.code};
    case TiltError::kStatusWord:
      return {EventPriority::kError,
              "tilt servo: it does not switch on, or not find its zero: its status word (6041h) is {:04X}h",
              event.code};
    case TiltError::kDeviceType:
      return {EventPriority::kError,
              "tilt servo: it is no drive of CiA 402: its device type (1000h) is {:08X}h and should end in 0192h",
              event.code};
    case TiltError::kHardware:
      return {EventPriority::kError,
              "tilt servo: hardware error {:02X}h, the sum of 1 voltage, 4 heat, 8 encoder, 10h circuit, 20h overload",
              event.code};
    case TiltError::kModel:
      return {
          EventPriority::kError,
          "tilt servo: it is a Dynamixel of model number {}, whose control table is another than those of the X and P "
          "series that this driver knows",
          event.code};
    case TiltError::kErrorFlags:
      return {EventPriority::kError,
              "tilt servo: its Maestro reports error {:04X}h, the sum of 1 signal, 2 overrun, 4 full, 8 check sum, 10h "
              "protocol, 20h timeout, 40h to 100h script",
              event.code};
    case TiltError::kNone:
      break;
  }
  return {EventPriority::kError, "tilt servo: it reports an error, code {:#x}", event.code};
}

EventText lost_text(Errc reason) {
  switch (reason) {
    case Errc::kDeviceSilent:
      return "tilt servo: it does not answer, and is asked again and again (has it power? tilt.id, bit rate, wires?)";
    case Errc::kDeviceStatus:
      return "tilt servo: lost: it has an error, or something else stopped it; restarting it";
    case Errc::kWrongDevice:
      return "tilt servo: what answers is another device (tilt.id); it is asked again and again";
    case Errc::kDeviceRestarted:
      return "tilt servo: it restarted or was switched off; initialising it";
    case Errc::kBusOff:
      return "tilt servo: too many errors on its bus: the CAN controller has left it (bit rate, wires, termination?)";
    case Errc::kHomingFailed:
      return "tilt servo: it does not find its zero (tilt.homing_method, tilt.homing_timeout_ms); it is tried again";
    default:
      return "tilt servo: lost; reconnecting";
  }
}

EventText rejected_text(Errc reason) {
  switch (reason) {
    case Errc::kWrongSum:
      return "tilt servo: an answer with a wrong check sum was refused (wires, tilt.baud?)";
    case Errc::kWrongEcho:
      return "tilt servo: an answer to something that was not asked was refused (is another one on its bus?)";
    case Errc::kImplausibleAngle:
      return "tilt servo: an angle was refused that it cannot have come to";
    case Errc::kImplausibleStamp:
      return "tilt servo: an angle was refused that came twice or late";
    default:
      return "tilt servo: an answer was refused that its protocol does not know";
  }
}

}  // namespace

TiltEventText text_of(const TiltEvent& event) {
  switch (event.type) {
    case TiltEventType::kReady:
      return {EventPriority::kInfo, "tilt servo: set up, obeys"};
    case TiltEventType::kRejected:
      return {EventPriority::kWarning, rejected_text(event.reason)};
    case TiltEventType::kDeviceError:
      return error_text(event);
    case TiltEventType::kStalled:
      return {EventPriority::kError, "tilt servo: stalled: it was stopped, and is tried again"};
    case TiltEventType::kLost:
      return {EventPriority::kWarning, lost_text(event.reason)};
    case TiltEventType::kDoesWithout:
      return {EventPriority::kNotice, kLackTexts.at(static_cast<std::size_t>(event.code))};
    case TiltEventType::kBusError:
      break;
  }
  return {EventPriority::kWarning, "tilt servo: errors on its bus, class {:#x}", event.code};
}

}  // namespace odoless
