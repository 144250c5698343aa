// A program with its own end for a broken invariant, as a robot's firmware without a console needs.

#include <cstdlib>

#include "core/scan/scan_frame.hpp"

namespace odoless {

void check_failed(const char* /*condition*/, const char* /*file*/, int /*line*/) { std::_Exit(42); }

}  // namespace odoless

int main() { const odoless::ScanFrame frame(odoless::ScanParams{.beams_max = -1}); }
