// Preloaded before libgpiod: a chip that is pulled out, while the file that ODOLESS_LOST_GPIO names is there. Linux 6.1
// itself corrupts its memory when a simulated chip goes whose lines are in use.
#include <dlfcn.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

struct gpiod_line;

extern "C" int gpiod_line_get_value(gpiod_line* line) {
  using Real = int (*)(gpiod_line*);
  static const Real real = reinterpret_cast<Real>(::dlsym(RTLD_NEXT, "gpiod_line_get_value"));
  const char* const lost = std::getenv("ODOLESS_LOST_GPIO");
  if (lost != nullptr && ::access(lost, F_OK) == 0) {
    errno = ENODEV;
    return -1;
  }
  return real(line);
}
