#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "drivers/lrf/sick/scan_stream.hpp"

namespace odoless {

/// What a client has asked an emulated SICK to send, once or again and again.
struct SickOutput {
  int answer = sick::kScanReply;  ///< command of its telegrams
  int scans = 1;                  ///< of which it is the mean
  int first = 1;                  ///< value of a scan, counted from 1 ...
  int last = 0;                   ///< ... to this one
  bool by_turns = false;          ///< the values of each turn of the mirror by themselves

  [[nodiscard]] bool is_part() const;
  [[nodiscard]] int values() const { return last - first + 1; }
  [[nodiscard]] bool is_mean() const { return scans > 1; }
  /// Turns of the mirror that one telegram's scan takes.
  [[nodiscard]] int turns(const sick::Variant& variant) const { return by_turns ? 1 : variant.turns(); }
  /// Bytes of a telegram, all included.
  [[nodiscard]] std::size_t telegram_bytes() const;
};

/// What operating mode `mode` (24h, 26h to 28h, 2Ah) streams, with its parameters behind it; nothing where there is no
/// such mode or its parameters are wrong.
[[nodiscard]] std::optional<SickOutput> sick_streamed(int mode, std::string_view parameters,
                                                      const sick::Variant& variant);

/// What a request (30h, 36h, 37h, 3Fh) asks for once, its parameters behind it.
[[nodiscard]] std::optional<SickOutput> sick_requested(int command, std::string_view parameters,
                                                       const sick::Variant& variant);

}  // namespace odoless
