#include "drivers/io/device_advice.hpp"

#include <gmock/gmock.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

using ::testing::HasSubstr;

TEST(DeviceAdvice, NamesTheGroupThatMayUseADevice) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("tty", "").string();
  ASSERT_EQ(::chmod(path.c_str(), 0660), 0);
  const group* dialout = ::getgrnam("dialout");
  std::string name = ::getgrgid(::getgid())->gr_name;
  if (dialout != nullptr && ::chown(path.c_str(), ::getuid(), dialout->gr_gid) == 0) {  // root may
    name = "dialout";
  }
  const std::string said = device_error_text(Errc::kDeviceDenied, path);
  EXPECT_THAT(said, HasSubstr("this user may not use the device; it belongs to the group " + name));
  EXPECT_THAT(said, HasSubstr("sudo usermod -aG " + name + " $USER"));
}

TEST(DeviceAdvice, SaysNothingOfAGroupThatIsNotAllowedEither) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("tty", "").string();
  ASSERT_EQ(::chmod(path.c_str(), 0600), 0);
  EXPECT_EQ(device_error_text(Errc::kDeviceDenied, path), describe(Errc::kDeviceDenied));
  EXPECT_EQ(group_advice("/nonexistent"), "");
}

TEST(DeviceAdvice, SaysWhereToLookForADeviceThatIsMissing) {
  EXPECT_THAT(device_error_text(Errc::kDeviceMissing, "/dev/nonexistent"), HasSubstr("odoless probe"));
  EXPECT_THAT(device_error_text(Errc::kDeviceMissing, "tcp://laser:1"), HasSubstr("its name is not known"));
  EXPECT_THAT(device_error_text(Errc::kDeviceMissing, "udp://10.9.8.7:2111"), HasSubstr("an address of this machine"));
  EXPECT_EQ(device_error_text(Errc::kDeviceDenied, "udp://10.9.8.7:2111"), describe(Errc::kDeviceDenied));
  EXPECT_THAT(device_error_text(Errc::kDeviceDenied, "usb://15d1:0000"), HasSubstr("udev"));
  EXPECT_EQ(device_error_text(Errc::kDeviceBusy, "/dev/null"), describe(Errc::kDeviceBusy));
}

}  // namespace
}  // namespace odoless
