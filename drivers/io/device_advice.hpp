#pragma once

#include <string>
#include <string_view>

#include "core/base/result.hpp"

namespace odoless {

/// Why a device cannot be opened, for a person, and what to do about it where that is known: whose group it is, where
/// to look for another.
[[nodiscard]] std::string device_error_text(Errc error, std::string_view address);

/// How to be allowed what the group of that file is: "it belongs to the group dialout: ..."; empty where the group may
/// not use it either, or there is no such file.
[[nodiscard]] std::string group_advice(const std::string& path);

}  // namespace odoless
