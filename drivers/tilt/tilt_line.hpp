#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "drivers/io/file_descriptor.hpp"
#include "drivers/tilt/tilt_params.hpp"
#include "drivers/tilt/tilt_session.hpp"
#include "rt/clock.hpp"

namespace odoless {

/// The session of the servo that `params` name; there must be one (not TiltDriver::kNone).
[[nodiscard]] std::unique_ptr<TiltSession> make_tilt_session(const TiltParams& params);

/// Opens the servo's line; errors and contract of open_can or open_serial.
[[nodiscard]] Result<FileDescriptor> open_tilt_line(const TiltParams& params);

/// What one read of a servo's line gave.
struct TiltRead {
  std::span<const std::byte> bytes{};
  std::int64_t arrival_ns = 0;  ///< by the clock: of CAN the kernel's stamp, else the time after the read
};

/// Takes what waits, on CAN one frame.
///
/// Errors: Errc::kNotYet: nothing waits; kLinkDown: it may come back by itself; else the line is to be opened anew.
/// Real time: one system call (read or recvmsg), no allocation.
[[nodiscard]] Result<TiltRead> read_tilt_line(TiltDriver driver, int descriptor, std::span<std::byte> buffer,
                                              const Clock& clock);

/// Writes one frame, or drops it. @return as write_can. Real time: one system call (write), no allocation.
[[nodiscard]] Errc write_tilt_line(TiltDriver driver, int descriptor, std::span<const std::byte> frame);

}  // namespace odoless
