#include "drivers/io/gpio_line.hpp"

#include <gtest/gtest.h>

// What a chip does is tested in the virtual machine (tests/hil), which has one.
namespace odoless {
namespace {

TEST(GpioLine, IsNamedByChipAndOffsetOrByAName) {
  const auto place = detail::parse_gpio_place("gpiochip0:17");
  ASSERT_TRUE(place.has_value());
  EXPECT_EQ(place->chip, "/dev/gpiochip0");
  EXPECT_EQ(place->offset, 17U);
  EXPECT_EQ(detail::parse_gpio_place("/dev/gpiochip2:0")->chip, "/dev/gpiochip2");
  for (const char* const name : {"ESTOP", "", "chip:", "chip:x", ":3", "chip:-1", "chip:99999999999"}) {
    EXPECT_FALSE(detail::parse_gpio_place(name).has_value()) << name;
  }
}

TEST(GpioLine, SaysThatAChipOrALineIsNotThere) {
  EXPECT_EQ(GpioLine::open_input("gpiochip999:1", GpioPull::kNone).error(), Errc::kDeviceMissing);
  EXPECT_EQ(GpioLine::open_output("odoless-no-such-line", false).error(), Errc::kDeviceMissing);
}

}  // namespace
}  // namespace odoless
