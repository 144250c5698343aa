#include "drivers/io/serial_port.hpp"

#include <asm/termbits.h>  // termios2; not together with <termios.h>, which declares the same structs
#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <optional>

namespace odoless {
namespace {

Errc open_error(int error_number) {
  switch (error_number) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
    case EIO:  // the far end of a pseudo-terminal is gone
    case ELOOP:
      return Errc::kDeviceMissing;
    case EBUSY:
    case EWOULDBLOCK:
      return Errc::kDeviceBusy;
    case EACCES:
    case EPERM:
      return Errc::kDeviceDenied;
    default:
      return Errc::kDeviceFailed;
  }
}

/// The lock keeps out processes of root too, which the terminal's own exclusive mode lets in. A pseudo-terminal would
/// keep that mode after its user was killed, so there the lock has to do.
std::optional<Errc> make_exclusive(int descriptor) {
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    return open_error(errno);
  }
  struct stat status {};
  const bool is_pseudo_terminal = ::fstat(descriptor, &status) == 0 && major(status.st_rdev) >= 136U &&
                                  major(status.st_rdev) <= 143U;  // Documentation/admin-guide/devices.txt of Linux
  if (!is_pseudo_terminal && ::ioctl(descriptor, TIOCEXCL) != 0) {
    return open_error(errno);
  }
  return {};
}

void set_raw(termios2& settings) {
  settings.c_iflag = IGNPAR;
  settings.c_oflag = 0;
  settings.c_lflag = 0;
  settings.c_cflag &= ~static_cast<tcflag_t>(CSIZE | PARENB | CSTOPB | CRTSCTS | HUPCL);
  settings.c_cflag |= CS8 | CREAD | CLOCAL;
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
}

void set_rate(termios2& settings, int baud) {
  settings.c_cflag &= ~static_cast<tcflag_t>(CBAUD | (CBAUD << IBSHIFT));
  settings.c_cflag |= BOTHER | (static_cast<tcflag_t>(BOTHER) << IBSHIFT);
  settings.c_ispeed = static_cast<speed_t>(baud);
  settings.c_ospeed = static_cast<speed_t>(baud);
}

Errc configure(int descriptor) {
  termios2 settings{};
  if (::ioctl(descriptor, TCGETS2, &settings) != 0) {
    return errno == ENOTTY ? Errc::kNotSerial : open_error(errno);
  }
  set_raw(settings);
  return ::ioctl(descriptor, TCSETS2, &settings) == 0 ? Errc::kOk : open_error(errno);
}

}  // namespace

Errc set_serial_baud(int descriptor, int baud) {
  termios2 settings{};
  if (baud <= 0 || ::ioctl(descriptor, TCGETS2, &settings) != 0) {
    return Errc::kBaudRefused;
  }
  set_rate(settings, baud);
  // A driver that cannot have a rate takes another one, or keeps the old one, and calls that a success.
  const bool is_set = ::ioctl(descriptor, TCSETS2, &settings) == 0 && baud_fits(baud, serial_baud(descriptor));
  return is_set ? Errc::kOk : Errc::kBaudRefused;
}

bool baud_fits(int wanted_baud, int had_baud) {
  const std::int64_t off_baud = std::abs(std::int64_t{had_baud} - wanted_baud);
  return 100 * off_baud < std::int64_t{3} * wanted_baud;
}

int serial_baud(int descriptor) {
  termios2 settings{};
  return ::ioctl(descriptor, TCGETS2, &settings) == 0 ? static_cast<int>(settings.c_ospeed) : 0;
}

Result<FileDescriptor> open_serial(const SerialParams& params) {
  FileDescriptor port(::open(params.path.c_str(), O_RDWR | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (!port.valid()) {
    return open_error(errno);
  }
  if (::isatty(port.get()) != 1) {
    return Errc::kNotSerial;
  }
  if (const std::optional<Errc> refused = make_exclusive(port.get()); refused.has_value()) {
    return *refused;
  }
  if (const Errc error = configure(port.get()); error != Errc::kOk) {
    return error;
  }
  if (const Errc error = params.baud == 0 ? Errc::kOk : set_serial_baud(port.get(), params.baud); error != Errc::kOk) {
    return error;
  }
  static_cast<void>(::ioctl(port.get(), TCFLSH, TCIOFLUSH));
  return port;
}

}  // namespace odoless
