#include "core/base/result.hpp"

namespace odoless {

namespace {

/// Of axes, and of what they are connected by.
const char* describe_motion(Errc error) {
  switch (error) {
    case Errc::kNotYet:
      return "of that moment nothing is known yet";
    case Errc::kTooOld:
      return "of that moment nothing is known any more";
    case Errc::kGap:
      return "what is known lies too far around that moment";
    case Errc::kImplausibleAngle:
      return "the axis cannot have come to the angle that it tells";
    case Errc::kWrongDevice:
      return "the device is another one than configured";
    case Errc::kDeviceRestarted:
      return "the device has started anew";
    case Errc::kStalled:
      return "the axis does not move as it should";
    case Errc::kHomingFailed:
      return "the axis does not find its zero";
    case Errc::kBusOff:
      return "the controller has left the bus because of too many errors";
    case Errc::kLinkDown:
      return "the network interface is down";
    case Errc::kNotCan:
      return "the network interface is no CAN interface, or the system has no CAN";
    default:
      return "unknown error";
  }
}

}  // namespace

const char* describe(Errc error) {
  switch (error) {
    case Errc::kOk:
      return "no error";
    case Errc::kTooManyBeams:
      return "the scan has more beams than the frame has room for";
    case Errc::kTooFewReturns:
      return "the scan has too few valid returns";
    case Errc::kBadGeometry:
      return "the scan's angles are not finite or its step is zero";
    case Errc::kNoReference:
      return "no reference has been set";
    case Errc::kCapacity:
      return "a fixed pool is full";
    case Errc::kBadAddress:
      return "the address or name cannot be used";
    case Errc::kUnavailable:
      return "the network or a service of the system refuses";
    case Errc::kTooLong:
      return "the message is too long";
    case Errc::kMalformed:
      return "the message does not follow its format";
    case Errc::kUnknownType:
      return "the message is of another type";
    case Errc::kBadNumber:
      return "a number in the message is not finite or out of its range";
    case Errc::kDeviceMissing:
      return "there is no such device, or it is unplugged";
    case Errc::kDeviceBusy:
      return "another process uses the device";
    case Errc::kDeviceDenied:
      return "this user may not use the device";
    case Errc::kDeviceFailed:
      return "the device could not be opened or set up";
    case Errc::kNotSerial:
      return "the path is no serial line";
    case Errc::kBaudRefused:
      return "the serial line cannot have that rate";
    case Errc::kFrameTooLong:
      return "a reply is longer than any that was asked for";
    case Errc::kFrameTruncated:
      return "a reply has too few lines or values";
    case Errc::kFrameMalformed:
      return "a reply has a byte, a line or a number that its protocol doesn't know";
    case Errc::kWrongSum:
      return "a check sum doesn't match";
    case Errc::kWrongEcho:
      return "a reply to something that wasn't asked";
    case Errc::kWrongCount:
      return "a scan has more or fewer beams than were asked for";
    case Errc::kImplausibleStamp:
      return "the device's own clock says what cannot be";
    case Errc::kDeviceStatus:
      return "the device answered with an error status";
    case Errc::kDeviceSilent:
      return "the device doesn't answer, or has stopped sending";
    default:
      return describe_motion(error);
  }
}

}  // namespace odoless
