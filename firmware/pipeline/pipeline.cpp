#include "firmware/pipeline/pipeline.hpp"

namespace odoless {
namespace {

constexpr std::size_t kEvents = 64;
constexpr std::size_t kCommands = 16;
// In the outboxes, half a second of scans at 40 Hz, and the tiles of as many.
constexpr std::size_t kScansWaiting = 20;
constexpr std::size_t kSmallOutbox_bytes = std::size_t{1} << 16;
// Some 300 changes of GPIO lines: two seconds of pulses at 75 Hz.
constexpr std::size_t kGpioOutbox_bytes = std::size_t{1} << 14;
constexpr std::size_t kTileOutbox_bytes = std::size_t{1} << 20;
// In the hands of sensor, matcher and filter, and held back by the matcher while the motion queue is full.
constexpr int kSlotsInHand = 4;

int slots_of(const PipelineParams& params) { return params.scan_queue + params.motion_queue + kSlotsInHand; }

// Ranges, and raw bytes of the device besides, which are about as many.
std::size_t scan_outbox_bytes(const ScanParams& scan) {
  return kScansWaiting * (sizeof(ScanRecord) + static_cast<std::size_t>(scan.beams_max) * 2 * sizeof(float)) +
         kSmallOutbox_bytes;
}

}  // namespace

Pipeline::Pipeline(const PipelineParams& params, const RobotParams& robot, bool lossless_replay)
    : lossless(lossless_replay),
      pool(robot.scan, slots_of(params)),
      scans(static_cast<std::size_t>(params.scan_queue)),
      motions(static_cast<std::size_t>(params.motion_queue)),
      slots_from_matcher(static_cast<std::size_t>(slots_of(params))),
      slots_from_filter(static_cast<std::size_t>(slots_of(params))),
      commands(kCommands),
      sensor(scan_outbox_bytes(robot.scan), kEvents),
      matcher(kSmallOutbox_bytes, kEvents),
      filter(kTileOutbox_bytes, kEvents),
      gpio(kGpioOutbox_bytes) {}

std::int64_t Pipeline::records_dropped() const {
  return static_cast<std::int64_t>(sensor.outbox.ring().rejected() + matcher.outbox.ring().rejected() +
                                   filter.outbox.ring().rejected() + gpio.ring().rejected());
}

}  // namespace odoless
