#include "firmware/sources/line_end.hpp"

#include <cerrno>

namespace odoless {

LineEnd line_end_of(bool is_tcp, int error_number) {
  switch (error_number) {
    case 0:
      return is_tcp ? LineEnd::kClosed : LineEnd::kUnplugged;
    case ECONNRESET:
    case ECONNABORTED:
    case ECONNREFUSED:
    case EPIPE:
      return LineEnd::kReset;
    case ETIMEDOUT:
      return LineEnd::kTimedOut;
    case EHOSTUNREACH:
    case EHOSTDOWN:
    case ENETUNREACH:
    case ENETDOWN:
      return LineEnd::kUnreachable;
    case EIO:
    case ENODEV:
    case ENXIO:
      return LineEnd::kUnplugged;
    default:
      return LineEnd::kFailed;
  }
}

EventText laser_line_text(LineEnd end) {
  switch (end) {
    case LineEnd::kClosed:
      return "laser: the device closed the connection; it is opened again as soon as it can be";
    case LineEnd::kReset:
      return "laser: the device broke the connection off, as one does that was switched off and on; it is opened again";
    case LineEnd::kTimedOut:
      return "laser: the device does not answer on the network any more: the connection timed out (power, cable?); it "
             "is "
             "opened again";
    case LineEnd::kUnreachable:
      return "laser: its network address cannot be reached any more (cable, network?); the connection is opened again";
    case LineEnd::kUnplugged:
      return "laser: its line was unplugged or closed at the other end; it is opened again when it is back";
    case LineEnd::kFailed:
      break;
  }
  return "laser: its line cannot be read (errno {}); it is opened again";
}

}  // namespace odoless
