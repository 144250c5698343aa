#pragma once

#include <string>
#include <string_view>

namespace odoless {

/// A command of somebody at the page, which may less than who reaches the control socket: pause and resume mapping,
/// save where the run saves anyway, say where the robot is.
[[nodiscard]] bool page_may_ask(std::string_view line);

/// Carried out as any other, by way of the control socket. @return  The answer, for a person.
///
/// Thread: any but the supervisor's; waits for its answer.
[[nodiscard]] std::string obey_page(const std::string& socket_path, std::string_view line);

}  // namespace odoless
