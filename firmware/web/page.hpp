#pragma once

#include <string_view>

namespace odoless {

/// The files in page/, as they are in the program.
extern const std::string_view kPageHtml;
extern const std::string_view kPageScript;
extern const std::string_view kPageStyle;

}  // namespace odoless
