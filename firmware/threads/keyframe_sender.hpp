#pragma once

#include <cstddef>
#include <cstring>
#include <span>

#include "core/graph/keyframe_gate.hpp"
#include "firmware/pipeline/pipeline.hpp"
#include "firmware/threads/round.hpp"

namespace odoless {

/// Hands keyframes to the publisher, for the pose graph.
///
/// Thread: filter thread. Real time: no allocation; linear in a keyframe's beams. One that finds no room is tried again
/// with the next scan; in a lossless replay it waits for room.
class KeyframeSender {
 public:
  explicit KeyframeSender(const GraphParams& params) : gate_(params) {}

  /// Every motion. @return  Whether its scan is wanted.
  [[nodiscard]] bool add(const Motion& motion, double unknown_s) { return gate_.add(motion, unknown_s); }

  void send(Pipeline& pipeline, const ScanFrame& scan, const Pose2& map_T_odom, int map_number) {
    const auto beams = static_cast<std::size_t>(gate_.beams(scan));
    const std::size_t size_bytes = sizeof(Keyframe) + beams * sizeof(BeamCode);
    std::span<std::byte> room = pipeline.filter.outbox.reserve(RecordType::kKeyframe, size_bytes);
    while (room.empty() && pipeline.lossless && !pipeline.abandoning) {
      sleep_ns(kRoomWait_ns);
      room = pipeline.filter.outbox.reserve(RecordType::kKeyframe, size_bytes);
    }
    if (room.empty()) {
      return;
    }
    Keyframe keyframe;
    gate_.encode(scan, map_T_odom, keyframe, {reinterpret_cast<BeamCode*>(room.data() + sizeof(Keyframe)), beams});
    keyframe.map_number = map_number;
    std::memcpy(room.data(), &keyframe, sizeof(Keyframe));
    pipeline.filter.outbox.commit();
    gate_.accept();
  }

 private:
  KeyframeGate gate_;
};

}  // namespace odoless
