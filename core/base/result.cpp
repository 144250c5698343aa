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
  }
  return "unknown error";
}

}  // namespace odoless
