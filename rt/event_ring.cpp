#include "rt/event_ring.hpp"

#include <fmt/args.h>

namespace odoless {

std::string format(const Event& event) {
  fmt::dynamic_format_arg_store<fmt::format_context> arguments;
  for (std::size_t i = 0; i < event.argument_count; ++i) {
    std::visit([&](auto number) { arguments.push_back(number); }, event.arguments[i]);
  }
  return fmt::vformat(event.format, arguments);
}

}  // namespace odoless
