#include "tools/emulate/recorded_gpio.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "tools/command/error.hpp"

namespace odoless {

RecordedGpio::RecordedGpio(const std::vector<RawPiece>& pieces, DueTime due_ns, const std::filesystem::path& path)
    : due_ns_(std::move(due_ns)) {
  for (const RawPiece& piece : pieces) {
    const std::optional<GpioChange> change = parse_gpio_text(piece.bytes);
    if (!change) {
      throw DataError(path.string(), 0, fmt::format("'{}' at {} us", piece.bytes, piece.time_us),
                      "a change of a GPIO line, such as 'stop low' and an end of line");
    }
    if (static_cast<std::size_t>(change->pin) < kGpioInputs && change->level != GpioLevel::kLost) {
      edges_.push_back({piece.time_us, change->pin, change->level == GpioLevel::kHigh});
    }
  }
  std::stable_sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) { return a.time_us < b.time_us; });
  for (auto edge = edges_.rbegin(); edge != edges_.rend(); ++edge) {
    is_high_.at(static_cast<std::size_t>(edge->pin)) = edge->high;
  }
}

void RecordedGpio::tick(std::int64_t now_ns) {
  while (next_ < edges_.size() && due_ns_(edges_[next_].time_us) <= now_ns) {
    const Edge& edge = edges_[next_++];
    is_high_.at(static_cast<std::size_t>(edge.pin)) = edge.high;
    if (edge.pin == GpioPin::kStop) {
      return;  // the next one in a round of its own, so that this one is seen
    }
  }
}

std::int64_t RecordedGpio::next_event_ns() const {
  return next_ < edges_.size() ? due_ns_(edges_[next_].time_us) : std::numeric_limits<std::int64_t>::max();
}

}  // namespace odoless
