#pragma once

#include <fmt/format.h>

#include <string>

#include "firmware/stages/scan_source.hpp"

namespace odoless::test {

/// All that a source of scans says and does, as text.
class Transcript final : public ScanSink {
 public:
  void on_scan(const RawScan& scan) override {
    text_ += fmt::format("scan {} {} {} {} {} beams:", scan.stamp_ns, scan.start_angle_rad, scan.angle_step_rad,
                         scan.beam_period_ns, scan.ranges_m.size());
    for (std::size_t i = 0; i < scan.ranges_m.size(); i += 10) {
      text_ += fmt::format(" {}", scan.ranges_m[i]);
    }
    text_ += '\n';
  }
  void on_motion(const Motion& motion) override { text_ += fmt::format("motion {}\n", motion.to_stamp_ns); }
  /// What is sent, and not what comes, which a device says as it is asked.
  void on_raw(RawLine /*line*/, std::span<const std::byte> bytes, bool to_device) override {
    if (to_device) {
      text_ += "to device:";
      for (const std::byte byte : bytes) {
        text_ += fmt::format(" {:02x}", static_cast<unsigned>(byte));
      }
      text_ += '\n';
    }
  }
  void on_tilt(const TiltRecord& tilt) override {
    text_ += fmt::format("tilt {} {} {}\n", tilt.stamp_ns, tilt.angle_rad, tilt.velocity_radps);
  }
  void on_event(EventPriority /*priority*/, EventText text, std::int64_t number) override {
    text_ += fmt::format(fmt::runtime(fmt::string_view(text)), number) + '\n';
  }

  void note(const std::string& line) { text_ += line + '\n'; }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace odoless::test
