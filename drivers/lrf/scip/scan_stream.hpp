#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "drivers/lrf/device_clock.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/scip/replies.hpp"

namespace odoless::scip {

/// What a scan of a reading looks like, but for its first line.
[[nodiscard]] ScanFormat format_of(LrfReading reading, int beams);

/// The stream of scans that is asked of one device, and what its frames mean.
///
/// The stamp of a scan is that of its first beam: the device's own, which tells when the mirror passed step 0, and the
/// turn from there to the first step.
/// Thread: one thread. Real time: no allocation after construction.
class ScanStream {
 public:
  ScanStream(const LrfParams& params, int beams_max);

  /// Fits the request to a device. Errc::kTooManyBeams: more than there is memory for.
  [[nodiscard]] Errc configure(const Parameters& device, int line_baud);

  /// MD, MS, ME, ND or NE with its line end, for as many scans as there will be.
  [[nodiscard]] std::string_view request() const { return {request_.data(), request_size_}; }
  [[nodiscard]] std::string_view echo() const { return request().substr(0, request_size_ - 1); }
  [[nodiscard]] const LrfGeometry& geometry() const { return geometry_; }

  /// One scan, from a reply that came at `arrival_ns`: the errors of scan_of, and Errc::kImplausibleStamp.
  [[nodiscard]] Result<LrfScan> scan(const Reply& reply, std::int64_t arrival_ns);

  /// How many scans in a row, up to the last one, were equal to the one before them.
  [[nodiscard]] std::uint64_t identical_run() const { return identical_run_; }
  /// The device has told the time of its clock since `configure`.
  void compare(const ClockReading& reading) { clock_.compare(reading); }
  [[nodiscard]] std::uint64_t clock_resets() const { return clock_.resets(); }

 private:
  void write_request(const Parameters& device);
  [[nodiscard]] float range_m(std::uint32_t range_mm) const;

  LrfParams params_;
  LrfGeometry geometry_;
  ScanFormat format_;
  std::uint32_t range_min_mm_ = 0;
  std::uint32_t range_far_mm_ = 0;  ///< this or more: nothing was hit
  std::uint32_t far_code_ = 0;      ///< the error code that says that nothing was hit
  std::int64_t first_beam_delay_ns_ = 0;
  std::int64_t beam_period_ns_ = 0;
  DeviceClock clock_;
  std::array<char, 24> request_{};
  std::size_t request_size_ = 1;
  std::vector<char> data_;
  std::vector<std::uint32_t> ranges_mm_;
  std::vector<std::uint32_t> last_ranges_mm_;
  std::vector<float> ranges_m_;
  std::uint64_t identical_run_ = 0;
};

}  // namespace odoless::scip
