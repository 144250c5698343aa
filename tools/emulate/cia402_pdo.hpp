#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "drivers/io/can_frame.hpp"
#include "tools/emulate/object_dictionary.hpp"

namespace odoless {

/// The PDOs of an emulated node, as its dictionary has them: who is sent when, and what a received one writes.
///
/// Sent at each n-th SYNC (types 1 to 240), at a SYNC after a change (0), or at once after a change and after the event
/// timer (254, 255), no sooner than the inhibit time allows. Received ones count at the next SYNC (0 to 240), or at
/// once.
class ProcessData {
 public:
  explicit ProcessData(ObjectDictionary& dictionary) : dictionary_(dictionary) {}

  /// The node has become operational: what was before is forgotten.
  void start() {
    sent_ = {};
    waiting_ = {};
  }

  /// A frame on whatever id. @return the objects that are written now, none of which took effect before all were.
  [[nodiscard]] std::vector<canopen::Object> receive(const CanFrame& frame);
  /// Whether a frame was shorter than what is mapped since the last question; it was not taken.
  [[nodiscard]] bool was_too_short();

  /// A SYNC: first what waited for it. @return the objects that are written now.
  [[nodiscard]] std::vector<canopen::Object> take_received();
  /// A SYNC: what is to be sent for it.
  [[nodiscard]] std::vector<CanFrame> at_sync();
  /// What is to be sent by itself, at that time of the node's own clock.
  [[nodiscard]] std::vector<CanFrame> at_time(double now_s);

 private:
  struct Sent {
    int syncs = 0;         ///< since it was sent
    double time_s = -1e9;  ///< when
    std::optional<CanFrame> frame;
  };

  /// Nothing where it isn't valid or maps nothing.
  [[nodiscard]] std::optional<CanFrame> content(std::uint16_t pdo) const;
  [[nodiscard]] std::vector<canopen::Object> take(std::uint16_t pdo, const CanFrame& frame);

  ObjectDictionary& dictionary_;
  std::array<Sent, ObjectDictionary::kPdos> sent_{};
  std::array<std::optional<CanFrame>, ObjectDictionary::kPdos> waiting_{};  ///< for the next SYNC
  bool was_too_short_ = false;
};

}  // namespace odoless
