#include "tools/emulate/pseudo_terminal.hpp"

#include <fcntl.h>
#include <poll.h>
#include <termios.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <utility>

#include "drivers/io/serial_port.hpp"
#include "tools/command/error.hpp"

namespace odoless {
namespace {

[[noreturn]] void fail(const std::filesystem::path& link, const std::string& reason) {
  throw CannotCreateError(link.string() + ": " + reason);
}

/// The settings stay with the line when this descriptor is closed.
bool make_raw(const std::string& path) {
  const FileDescriptor client(::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  if (!client.valid() || ::tcgetattr(client.get(), &settings) != 0) {
    return false;
  }
  ::cfmakeraw(&settings);
  return ::tcsetattr(client.get(), TCSANOW, &settings) == 0;
}

}  // namespace

PseudoTerminal::PseudoTerminal(std::filesystem::path link)
    : device_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)), link_(std::move(link)) {
  std::array<char, 128> path{};
  if (!device_.valid() || ::grantpt(device_.get()) != 0 || ::unlockpt(device_.get()) != 0 ||
      ::ptsname_r(device_.get(), path.data(), path.size()) != 0) {
    fail(link_, "no pseudo-terminal: " + system_reason(errno));
  }
  path_ = path.data();
  if (!make_raw(path_)) {
    fail(link_, path_ + ": " + system_reason(errno));
  }
  std::error_code error;
  if (std::filesystem::is_symlink(link_, error)) {
    std::filesystem::remove(link_, error);  // of an emulator that was killed
  }
  std::filesystem::create_symlink(path_, link_, error);
  if (error) {
    fail(link_, error.message());
  }
}

PseudoTerminal::~PseudoTerminal() {
  std::error_code ignored;
  if (std::filesystem::read_symlink(link_, ignored) == path_) {
    std::filesystem::remove(link_, ignored);
  }
}

bool PseudoTerminal::has_client() {
  pollfd line{.fd = device_.get(), .events = POLLIN, .revents = 0};
  return ::poll(&line, 1, 0) >= 0 && (line.revents & POLLHUP) == 0;
}

int PseudoTerminal::baud() { return serial_baud(device_.get()); }

std::string PseudoTerminal::read() {
  std::array<char, 4096> bytes{};
  const ssize_t count = ::read(device_.get(), bytes.data(), bytes.size());
  return {bytes.data(), count > 0 ? static_cast<std::size_t>(count) : 0};
}

std::size_t PseudoTerminal::write(std::string_view bytes) {
  const ssize_t count = ::write(device_.get(), bytes.data(), bytes.size());
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

}  // namespace odoless
