#include "firmware/web/web_params.hpp"

#include <fmt/format.h>

namespace odoless {

std::optional<TcpAddress> WebParams::address() const {
  const Result<DeviceAddress> parsed = parse_device_address("tcp://" + listen);
  return parsed.ok() ? std::optional(std::get<TcpAddress>(parsed.value())) : std::nullopt;
}

std::string WebParams::contradiction() const {
  return !is_used() || address()
             ? ""
             : fmt::format("web.listen = \"{}\": must be ADDRESS:PORT, as in 127.0.0.1:8080, or empty", listen);
}

}  // namespace odoless
