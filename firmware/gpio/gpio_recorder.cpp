#include "firmware/gpio/gpio_recorder.hpp"

#include <utility>

namespace odoless {

void GpioRecorder::on_edge(GpioPin pin, bool high, std::int64_t stamp_ns) {
  const auto i = static_cast<std::size_t>(pin);
  const GpioLevel level = high ? GpioLevel::kHigh : GpioLevel::kLow;
  if (!std::exchange(told_before_its_edge_.at(i), false) || told_.at(i) != level) {
    tell({pin, level}, stamp_ns);
  }
}

void GpioRecorder::on_level(GpioPin pin, GpioLevel level, std::int64_t stamp_ns) {
  if (told_.at(static_cast<std::size_t>(pin)) != level) {
    tell({pin, level}, stamp_ns);
    told_before_its_edge_.at(static_cast<std::size_t>(pin)) = true;
  }
}

void GpioRecorder::tell(const GpioChange& change, std::int64_t stamp_ns) {
  const auto pin = static_cast<std::size_t>(change.pin);
  told_.at(pin) = change.level;
  std::array<char, kGpioTextMax> buffer{};
  const std::string_view text = gpio_text(change, buffer);
  RawBytesRecord record;
  record.stamp_ns = stamp_ns;
  record.size_bytes = static_cast<std::int32_t>(text.size());
  record.to_device = pin < kGpioInputs ? 0 : 1;
  record.line = RawLine::kGpio;
  static_cast<void>(outbox_.send(RecordType::kRawBytes, record, std::as_bytes(std::span(text))));
}

}  // namespace odoless
