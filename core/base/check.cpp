#include "core/base/check.hpp"

#include <cstdio>
#include <cstdlib>

namespace odoless {

void check_failed(const char* condition, const char* file, int line) {
  static_cast<void>(std::fprintf(stderr, "%s:%d: broken invariant: %s\n", file, line, condition));
  std::abort();
}

}  // namespace odoless
