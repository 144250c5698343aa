#pragma once

#include <string>
#include <vector>

#include "tools/replay/verdict.hpp"

namespace odoless {

/// Says on stderr what was corrected in a log.
void tell_corrections(const std::string& log, const std::vector<std::string>& corrected);

/// Ends a job over a log with the line that tells its result. What is not good is said on stderr too where stdout goes
/// elsewhere than to a terminal. @throws UserError (65) for a strict job whose result is not good.
void close_job(const std::string& log, const Verdict& verdict, bool strict);

}  // namespace odoless
