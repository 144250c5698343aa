#include "tools/emulate/gpio_sim_chip.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <linux/gpio.h>
#include <sys/ioctl.h>

#include <cstdint>
#include <filesystem>
#include <fstream>

#include "drivers/io/file_descriptor.hpp"
#include "tools/command/error.hpp"

namespace odoless {
namespace {

constexpr const char* kChips = "/sys/kernel/config/gpio-sim";

bool write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text << '\n' << std::flush;
  return file.good();
}

std::optional<std::string> read_text(const std::string& path) {
  std::ifstream file(path);
  std::string text;
  return std::getline(file, text) ? std::optional(text) : std::nullopt;
}

}  // namespace

GpioSimChip::GpioSimChip(const std::string& name, std::span<const std::string> lines)
    : folder_(fmt::format("{}/{}", kChips, name)), lines_(lines.size()) {
  const bool is_there = read_text(folder_ + "/live") == "1";
  if (!is_there) {
    make(lines);
  }
  const auto chip = read_text(folder_ + "/bank0/chip_name");
  const auto device = read_text(folder_ + "/dev_name");
  if (!chip || !device || read_text(folder_ + "/live") != "1") {
    throw CannotCreateError(
        fmt::format("{}: a chip of gpio-sim cannot be made; expected the kernel's module gpio-sim "
                    "(modprobe gpio-sim), configfs in /sys/kernel/config, and root",
                    folder_));
  }
  device_ = *chip;
  pins_ = fmt::format("/sys/devices/platform/{}/{}", *device, *chip);
}

void GpioSimChip::make(std::span<const std::string> lines) {
  std::error_code error;
  const std::string bank = folder_ + "/bank0";
  std::filesystem::create_directories(bank, error);
  bool written = !error && write_text(bank + "/num_lines", std::to_string(lines.size()));
  for (std::size_t i = 0; i < lines.size() && written; ++i) {
    const std::string line = fmt::format("{}/line{}", bank, i);
    std::filesystem::create_directory(line, error);
    written = !error && write_text(line + "/name", lines[i]);
  }
  static_cast<void>(write_text(folder_ + "/live", "1"));  // whether it lives is looked at afterwards
}

GpioSimChip::~GpioSimChip() {
  if (is_in_use() || !write_text(folder_ + "/live", "0")) {
    return;
  }
  std::error_code ignored;
  for (std::size_t i = 0; i < lines_; ++i) {
    std::filesystem::remove(fmt::format("{}/bank0/line{}", folder_, i), ignored);
  }
  std::filesystem::remove(folder_ + "/bank0", ignored);
  std::filesystem::remove(folder_, ignored);
}

bool GpioSimChip::is_in_use() const {
  const FileDescriptor chip(::open(("/dev/" + device_).c_str(), O_RDWR | O_CLOEXEC));
  for (std::size_t i = 0; i < lines_; ++i) {
    gpio_v2_line_info info{};
    info.offset = static_cast<std::uint32_t>(i);
    if (!chip.valid() || ::ioctl(chip.get(), GPIO_V2_GET_LINEINFO_IOCTL, &info) != 0 ||
        (info.flags & GPIO_V2_LINE_FLAG_USED) != 0) {
      return true;
    }
  }
  return false;
}

std::string GpioSimChip::pin(std::size_t line) const { return fmt::format("{}/sim_gpio{}", pins_, line); }

void GpioSimChip::set(std::size_t line, bool high) {
  if (!write_text(pin(line) + "/pull", high ? "pull-up" : "pull-down")) {
    throw IoError(fmt::format("{}: line {} cannot be driven: the chip is gone", device_, line));
  }
}

std::optional<bool> GpioSimChip::value(std::size_t line) const {
  const auto text = read_text(pin(line) + "/value");
  return text ? std::optional(*text == "1") : std::nullopt;
}

}  // namespace odoless
