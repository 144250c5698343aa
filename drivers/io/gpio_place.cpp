#include <cerrno>
#include <charconv>

#include "drivers/io/gpio_line.hpp"

namespace odoless::detail {

std::optional<GpioPlace> parse_gpio_place(const std::string& name) {
  const std::size_t colon = name.rfind(':');
  if (colon == std::string::npos || colon == 0) {
    return std::nullopt;
  }
  GpioPlace place;
  const char* const text_end = name.data() + name.size();
  const auto [end, error] = std::from_chars(name.data() + colon + 1, text_end, place.offset);
  if (error != std::errc() || end != text_end) {
    return std::nullopt;
  }
  place.chip = (name.front() == '/' ? "" : "/dev/") + name.substr(0, colon);
  return place;
}

Errc gpio_error(int error_number) {
  switch (error_number) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
    case EINVAL:  // an offset beyond the chip's last
      return Errc::kDeviceMissing;
    case EBUSY:
      return Errc::kDeviceBusy;
    case EACCES:
    case EPERM:
      return Errc::kDeviceDenied;
    default:
      return Errc::kDeviceFailed;
  }
}

}  // namespace odoless::detail
