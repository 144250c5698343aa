#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/run_command.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/probe/connected.hpp"

namespace odoless {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A root with one laser on USB, one converter, one port that is only reserved, two networks and a GPIO chip.
class Machine {
 public:
  Machine() {
    const fs::path usb = "sys/devices/pci/usb1";
    write(usb / "1-1/idVendor", "15d1");
    write(usb / "1-1/idProduct", "0000");
    write(usb / "1-1/manufacturer", "Hokuyo");
    write(usb / "1-1/product", "URG-Series");
    fs::create_directories(root() / usb / "1-1/1-1:1.0");
    tty("ttyACM0", usb / "1-1/1-1:1.0");
    write(usb / "1-2/idVendor", "0403");
    write(usb / "1-2/idProduct", "6014");
    write(usb / "1-2/serial", "FT1");
    fs::create_directories(root() / usb / "1-2/1-2:1.0/ttyUSB0");
    tty("ttyUSB0", usb / "1-2/1-2:1.0/ttyUSB0");
    tty("ttyS0", "sys/devices/platform/serial8250");
    write("sys/class/tty/ttyS0/type", "0");
    tty("ttyS1", "sys/devices/pnp0");
    write("sys/class/tty/ttyS1/type", "4");
    fs::create_directories(root() / "sys/class/tty/tty1");
    fs::create_directories(root() / "dev/serial/by-id");
    fs::create_symlink("../../ttyACM0", root() / "dev/serial/by-id/usb-Hokuyo-if00");
    write("sys/class/net/eth0/type", "1");
    write("sys/class/net/vcan0/type", "280");
    fs::create_directories(root() / "sys/bus/gpio/devices/gpiochip0");
  }

  [[nodiscard]] const fs::path& root() const { return folder_.path(); }

 private:
  void write(const fs::path& path, const std::string& line) const {
    fs::create_directories((root() / path).parent_path());
    static_cast<void>(folder_.file(path, line + "\n"));
  }
  void tty(const std::string& name, const fs::path& device) const {
    fs::create_directories(root() / "sys/class/tty" / name);
    fs::create_directories(root() / device);
    fs::create_symlink(root() / device, root() / "sys/class/tty" / name / "device");
  }

  test::TemporaryFolder folder_;
};

TEST(Connected, SerialLinesWithWhatTheySayOfThemselves) {
  const Machine machine;
  const std::vector<SerialDevice> devices = connected_serial_devices(machine.root());
  ASSERT_EQ(devices.size(), 3U) << "neither consoles nor ports that are only reserved";
  EXPECT_EQ(devices[0].path, "/dev/ttyACM0");
  EXPECT_EQ(devices[0].stable_path, "/dev/serial/by-id/usb-Hokuyo-if00");
  EXPECT_EQ(devices[0].vendor + ":" + devices[0].product, "15d1:0000");
  EXPECT_EQ(devices[0].name, "Hokuyo URG-Series");
  EXPECT_EQ(devices[0].serial, "");
  EXPECT_EQ(devices[1].path, "/dev/ttyS1");
  EXPECT_EQ(devices[1].vendor, "");
  EXPECT_EQ(devices[2].stable_path, "/dev/ttyUSB0") << "it has no other name";
  EXPECT_EQ(devices[2].serial, "FT1");
}

TEST(Connected, CanInterfacesAndGpioChips) {
  const Machine machine;
  EXPECT_THAT(connected_can_interfaces(machine.root()), ElementsAre("vcan0"));
  EXPECT_THAT(connected_gpio_chips(machine.root()), ElementsAre("gpiochip0"));
}

TEST(Connected, NothingOnAMachineWithoutAnything) {
  const test::TemporaryFolder empty;
  EXPECT_THAT(connected_serial_devices(empty.path()), IsEmpty());
  EXPECT_THAT(connected_can_interfaces(empty.path()), IsEmpty());
  EXPECT_THAT(connected_gpio_chips(empty.path()), IsEmpty());
}

TEST(Probe, SaysWhyNobodyAnswers) {
  const test::Outcome outcome = test::run({"probe", "/nowhere/at/all", "tcp://laser", "--patience-s", "0.2"});
  EXPECT_EQ(outcome.status, 69);
  EXPECT_THAT(outcome.out,
              HasSubstr("# /nowhere/at/all\n#   no laser that speaks SCIP (Hokuyo) answers: there is no such device"));
  EXPECT_THAT(outcome.out, HasSubstr("# tcp://laser\n"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("SICK"))) << "what cannot be opened is not asked three times";
}

}  // namespace
}  // namespace odoless
