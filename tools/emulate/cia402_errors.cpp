#include "tools/emulate/cia402_errors.hpp"

namespace odoless {
namespace {

using canopen::Object;

constexpr Object kRegister{0x1001, 0};
constexpr std::uint8_t kHistory = 4;
constexpr std::uint32_t kNotSent = 1U << 31U;
constexpr std::uint32_t kIdMask = 0x7FF;

/// The bit of the error register that a code belongs to, besides the lowest, which any error sets.
std::uint8_t register_bit(std::uint16_t code) {
  switch (code >> 12U) {
    case 2:
      return 1U << 1U;  // current
    case 3:
      return 1U << 2U;  // voltage
    case 4:
      return 1U << 3U;  // temperature
    case 8:
      return 1U << 4U;  // communication
    case 15:
      return 1U << 7U;  // of the manufacturer
    default:
      return 1U << 5U;  // of the profile
  }
}

}  // namespace

std::optional<CanFrame> NodeErrors::message(std::uint16_t code) const {
  const std::uint32_t cob = dictionary_.get({0x1014, 0});
  if ((cob & kNotSent) != 0) {
    return std::nullopt;
  }
  CanFrame frame;
  frame.id = cob & kIdMask;
  frame.size_bytes = 8;
  canopen::put(frame, 0, code, 2);
  frame.data[2] = static_cast<std::uint8_t>(dictionary_.get(kRegister));
  return frame;
}

std::optional<CanFrame> NodeErrors::raise(std::uint16_t code) {
  dictionary_.set(kRegister, dictionary_.get(kRegister) | 1U | register_bit(code));
  for (std::uint8_t sub = kHistory; sub > 1; --sub) {
    dictionary_.set({0x1003, sub}, dictionary_.get({0x1003, static_cast<std::uint8_t>(sub - 1)}));
  }
  dictionary_.set({0x1003, 1}, code);
  const std::uint32_t count = dictionary_.get({0x1003, 0});
  dictionary_.set({0x1003, 0}, count < kHistory ? count + 1 : count);
  return message(code);
}

std::optional<CanFrame> NodeErrors::clear() {
  if (dictionary_.get(kRegister) == 0) {
    return std::nullopt;
  }
  dictionary_.set(kRegister, 0);
  return message(kErrorsGone);
}

}  // namespace odoless
