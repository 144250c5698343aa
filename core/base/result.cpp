#include "core/base/result.hpp"

namespace odoless {

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
  }
  return "unknown error";
}

}  // namespace odoless
