#include "firmware/sources/device_status_text.hpp"

#include "drivers/lrf/sopas/bring_up.hpp"

namespace odoless {
namespace {

using sopas::kDeviceStatus;
using sopas::kScanRefused;

/// SICK's codes of refusals (sFA), and what its scans say of the device.
EventText sopas_status_text(int status) {
  switch (status) {
    case 1:
    case 10:
      return "laser: it refuses a request (sFA {}): the log-in is not allowed to; has its password been changed?";
    case 2:
    case 3:
    case 15:
      return "laser: it does not know a request (sFA {}): is it a TiM5xx, LMS1xx or LMS4xxx? lrf.sopas_scan is for "
             "LMS1xx only";
    case 4:
      return "laser: it refuses a value (sFA {}) that is outside its limits";
    case 12:
      return "laser: it does not know a command (sFA {})";
    case 13:
      return "laser: it is busy with another client (sFA {}); it is asked again";
    case kScanRefused + 1:
    case kScanRefused + 2:
    case kScanRefused + 3:
      return "laser: it cannot have the rate and step of lrf.sopas_scan (code {}); it keeps its own";
    case kDeviceStatus + 1:
      return "laser: it says that it is faulty (status {})";
    case kDeviceStatus + 2:
      return "laser: its window is dirty (status {}): clean it soon";
    case kDeviceStatus + 4:
    case kDeviceStatus + 5:
      return "laser: its window is too dirty to measure (status {}): clean it";
    default:
      return "laser: it reports an error, status {}";
  }
}

}  // namespace

EventText device_status_text(LrfDriver driver, int device_status) {
  return driver == LrfDriver::kSopas ? sopas_status_text(device_status)
                                     : EventText("laser: it reports an error, status {}");
}

}  // namespace odoless
