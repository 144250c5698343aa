#include "drivers/io/serial_port.hpp"

#include <asm/termbits.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string>
#include <utility>

namespace odoless {
namespace {

/// The far end of a line.
struct Terminal {
  Terminal() {
    EXPECT_EQ(::grantpt(device.get()), 0);
    EXPECT_EQ(::unlockpt(device.get()), 0);
    std::array<char, 128> name{};
    EXPECT_EQ(::ptsname_r(device.get(), name.data(), name.size()), 0);
    path = name.data();
  }
  FileDescriptor device{::posix_openpt(O_RDWR | O_NOCTTY)};
  std::string path;
};

TEST(SerialPort, CarriesEveryByteUnchangedBothWays) {
  const Terminal terminal;
  Result<FileDescriptor> opened = open_serial({.path = terminal.path, .baud = 115200});
  ASSERT_TRUE(opened.ok()) << describe(opened.error());
  const FileDescriptor port = opened.take();
  std::string all(256, '\0');
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i] = static_cast<char>(i);
  }
  std::string there(256, 'x');
  ASSERT_EQ(::write(port.get(), all.data(), all.size()), 256);
  EXPECT_EQ(::read(terminal.device.get(), there.data(), there.size()), 256);
  EXPECT_EQ(there, all);
  std::string back(256, 'x');
  ASSERT_EQ(::write(terminal.device.get(), all.data(), all.size()), 256);
  EXPECT_EQ(::read(port.get(), back.data(), back.size()), 256) << "and nothing is echoed";
  EXPECT_EQ(back, all);
}

TEST(SerialPort, DoesNotBlock) {
  const Terminal terminal;
  Result<FileDescriptor> opened = open_serial({.path = terminal.path});
  ASSERT_TRUE(opened.ok());
  char byte = 0;
  EXPECT_LE(::read(opened.value().get(), &byte, 1), 0);
  EXPECT_NE(::fcntl(opened.value().get(), F_GETFL) & O_NONBLOCK, 0);
  EXPECT_NE(::fcntl(opened.value().get(), F_GETFD) & FD_CLOEXEC, 0);
}

TEST(SerialPort, ThrowsAwayWhatCameBefore) {
  const Terminal terminal;
  { EXPECT_TRUE(open_serial({.path = terminal.path}).ok()); }
  const FileDescriptor other(::open(terminal.path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
  ASSERT_EQ(::write(terminal.device.get(), "stale", 5), 5);
  Result<FileDescriptor> opened = open_serial({.path = terminal.path});
  ASSERT_TRUE(opened.ok());
  ASSERT_EQ(::write(terminal.device.get(), "new", 3), 3);
  std::array<char, 16> bytes{};
  EXPECT_EQ(::read(opened.value().get(), bytes.data(), bytes.size()), 3);
  EXPECT_STREQ(bytes.data(), "new");
}

TEST(SerialPort, TakesAnyRate) {
  const Terminal terminal;
  for (const int baud : {9600, 19200, 250000, 500000, 750000, 123456}) {
    Result<FileDescriptor> opened = open_serial({.path = terminal.path, .baud = baud});
    EXPECT_TRUE(opened.ok()) << baud;
  }
  Result<FileDescriptor> opened = open_serial({.path = terminal.path});
  EXPECT_EQ(set_serial_baud(opened.value().get(), 57600), Errc::kOk);
  termios2 settings{};
  ASSERT_EQ(::ioctl(opened.value().get(), TCGETS2, &settings), 0);
  EXPECT_EQ(settings.c_ospeed, 57600U);
  EXPECT_EQ(settings.c_ispeed, 57600U);
  EXPECT_EQ(set_serial_baud(opened.value().get(), 0), Errc::kBaudRefused);
  EXPECT_EQ(set_serial_baud(-1, 9600), Errc::kBaudRefused);
}

// As a modem's program may have left it: a lost handshake line would keep a laser silent, a second stop bit slow it
// down.
TEST(SerialPort, LeavesNothingOfWhatTheLineWasSetToBefore) {
  const Terminal terminal;
  const FileDescriptor other(::open(terminal.path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
  termios2 settings{};
  ASSERT_EQ(::ioctl(other.get(), TCGETS2, &settings), 0);
  settings.c_cflag |= CSTOPB | CRTSCTS | HUPCL;
  settings.c_iflag |= IXON | ICRNL;
  settings.c_lflag |= ECHO | ICANON;
  ASSERT_EQ(::ioctl(other.get(), TCSETS2, &settings), 0);
  ASSERT_TRUE(open_serial({.path = terminal.path}).ok());
  ASSERT_EQ(::ioctl(other.get(), TCGETS2, &settings), 0);
  EXPECT_EQ(settings.c_cflag & (CSIZE | CSTOPB | CRTSCTS | HUPCL | PARENB), tcflag_t{CS8});
  EXPECT_EQ(settings.c_cflag & (CREAD | CLOCAL), tcflag_t{CREAD | CLOCAL});
  EXPECT_EQ(settings.c_iflag, tcflag_t{IGNPAR});
  EXPECT_EQ(settings.c_oflag, tcflag_t{0});
  EXPECT_EQ(settings.c_lflag, tcflag_t{0});
}

// What real drivers answer where they cannot have a rate: a nearer one, 9600, or the one before.
TEST(SerialPort, TellsARateThatTheHardwareRoundsFromOneThatItCannotHave) {
  EXPECT_TRUE(baud_fits(500000, 500000));
  EXPECT_TRUE(baud_fits(256000, 255319)) << "48 MHz by 188";
  EXPECT_TRUE(baud_fits(115200, 118000));
  EXPECT_TRUE(baud_fits(4'000'000, 3'900'000));
  EXPECT_FALSE(baud_fits(115200, 111700));
  EXPECT_FALSE(baud_fits(500000, 460800));
  EXPECT_FALSE(baud_fits(500000, 115200));
  EXPECT_FALSE(baud_fits(500000, 9600));
  EXPECT_FALSE(baud_fits(500000, 0));
}

TEST(SerialPort, IsForOneProcessAlone) {
  const Terminal terminal;
  Result<FileDescriptor> opened = open_serial({.path = terminal.path});
  ASSERT_TRUE(opened.ok());
  EXPECT_EQ(open_serial({.path = terminal.path}).error(), Errc::kDeviceBusy);
  const pid_t other = ::fork();
  if (other == 0) {
    ::_exit(open_serial({.path = terminal.path}).error() == Errc::kDeviceBusy ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(other, &status, 0), other);
  EXPECT_EQ(status, 0) << "another process, root or not, must be refused";
  opened.take().reset();
  EXPECT_TRUE(open_serial({.path = terminal.path}).ok()) << "free again";
}

TEST(SerialPort, SaysWhyNot) {
  EXPECT_EQ(open_serial({.path = "/dev/no-such-laser"}).error(), Errc::kDeviceMissing);
  EXPECT_EQ(open_serial({.path = ""}).error(), Errc::kDeviceMissing);
  EXPECT_EQ(open_serial({.path = "/dev/null"}).error(), Errc::kNotSerial);
  EXPECT_EQ(open_serial({.path = "/"}).error(), Errc::kDeviceFailed) << "a directory";
  std::string gone;
  { gone = Terminal().path; }
  EXPECT_EQ(open_serial({.path = gone}).error(), Errc::kDeviceMissing);
}

TEST(FileDescriptor, ClosesOnceAndMoves) {
  FileDescriptor first(::open("/dev/null", O_RDONLY));
  const int number = first.get();
  FileDescriptor second(std::move(first));
  EXPECT_EQ(second.get(), number);
  FileDescriptor third;
  EXPECT_FALSE(third.valid());
  third = std::move(second);
  EXPECT_EQ(::fcntl(number, F_GETFD), 0);
  third.reset();
  EXPECT_EQ(::fcntl(number, F_GETFD), -1);
}

}  // namespace
}  // namespace odoless
