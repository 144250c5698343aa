#include "drivers/tilt/maestro/command.hpp"

#include <algorithm>

#include "core/base/check.hpp"

namespace odoless::maestro {

void Commands::put(unsigned byte) {
  ODOLESS_CHECK(size_ < bytes_.size());
  bytes_[size_++] = static_cast<std::byte>(byte);
}

Commands& Commands::add(Code code) {
  put(static_cast<unsigned>(code));
  return *this;
}

Commands& Commands::add(Code code, int channel) {
  put(static_cast<unsigned>(code));
  put(static_cast<unsigned>(channel) & 0x7FU);
  return *this;
}

Commands& Commands::add(Code code, int channel, unsigned number) {
  const unsigned cut = std::min(number, kNumberMax);
  add(code, channel);
  put(cut & 0x7FU);
  put(cut >> 7U);
  return *this;
}

}  // namespace odoless::maestro
