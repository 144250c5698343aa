#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/rng.hpp"
#include "tools/emulate/emulated_scans.hpp"
#include "tools/emulate/faults.hpp"

namespace odoless {

/// A scan that an emulated laser has sent.
struct SentScan {
  std::int64_t index = 0;          ///< of its source
  std::int64_t first_beam_ns = 0;  ///< when its first beam was measured, on the host's clock
};

/// Bytes that an emulated laser sends at once.
struct SentBytes {
  std::string bytes;
  std::optional<SentScan> scan;  ///< which these bytes complete
  bool one_by_one = false;
};

struct EmulatedLrfOptions {
  std::vector<Fault> faults;
  bool starts_at_once = false;         ///< the source's time starts at construction, not with the first stream
  std::uint32_t counter_start_ms = 0;  ///< of the device's clock at construction, where it has one
  std::uint64_t seed = 1;              ///< of what garbage is made of
  int rs232_baud = 0;                  ///< SCIP: it is on RS-232, at this rate at first; 0: on a line without one
};

/// A laser without a line: bytes and the host's time come in, bytes go out.
///
/// Its mirror turns all the time; what it sends comes in pieces (scans, or parts of scans), each when its last beam has
/// been measured and the line has carried it. The source's time starts with the first stream, or at once. Faults are
/// the same for every protocol. One thread.
class EmulatedLrf {
 public:
  EmulatedLrf(const EmulatedLrf&) = delete;
  EmulatedLrf& operator=(const EmulatedLrf&) = delete;
  virtual ~EmulatedLrf() = default;

  void receive(std::string_view bytes, std::int64_t now_ns);

  /// Sends what is due.
  void tick(std::int64_t now_ns);

  /// When `tick` has something to do next.
  [[nodiscard]] std::int64_t next_event_ns() const;

  /// What is to be sent, in order.
  [[nodiscard]] std::vector<SentBytes> take_output();

  /// Its supply: without, it is mute, and with it again, it starts anew. It is on at first.
  void set_power(bool on, std::int64_t now_ns);

  /// The source's time at the host's; nothing before it has started.
  [[nodiscard]] std::optional<std::int64_t> source_time_ns(std::int64_t now_ns) const;

  /// The rate that the client has set the line to; 0: a line that has none.
  void set_line_baud(int baud) { line_baud_ = baud; }

 protected:
  /// `source` must outlive it.
  EmulatedLrf(EmulatedScans& source, EmulatedLrfOptions options);

  /// One or more bytes from the client.
  virtual void hear(std::string_view bytes, std::int64_t now_ns) = 0;
  /// When a piece is due; pieces count from 0, and their times grow.
  [[nodiscard]] virtual std::int64_t due_ns(std::int64_t piece) const = 0;
  /// A piece is due.
  virtual void on_due(std::int64_t piece) = 0;
  /// It has lost its power for a moment.
  virtual void restart(std::int64_t now_ns) = 0;
  /// Its clock runs faster by so many parts in a million from now on.
  virtual void set_drift(double /*drift_ppm*/, std::int64_t /*now_ns*/) {}
  /// The rate that it sends at; 0: whatever the client's is.
  [[nodiscard]] virtual int baud() const { return 0; }

  void start_source(std::int64_t now_ns);
  [[nodiscard]] std::int64_t origin_ns() const { return origin_ns_.value_or(0); }
  /// The pieces have become others: goes on with the first that isn't due.
  void skip_to(std::int64_t now_ns);
  [[nodiscard]] std::int64_t next_piece() const { return next_piece_; }
  [[nodiscard]] bool fault(FaultKind kind, std::int64_t now_ns) const;
  [[nodiscard]] bool is_mute(std::int64_t now_ns) const;
  /// Measures a scan of the source, unless the laser is stuck.
  void measure(std::int64_t index, std::span<const EmulatedBeam> beams, std::span<double> ranges_m,
               std::int64_t now_ns);

  /// An answer.
  void send(std::string bytes, std::int64_t now_ns);
  /// An answer that takes its time: the line has carried it at `due_ns`, which never goes back.
  void send_later(std::string bytes, std::int64_t due_ns);
  /// It has lost its power: no answer that was still to come does.
  void forget_later() { later_.clear(); }
  /// A piece of the stream, with whatever faults damage it.
  void send_piece(std::string bytes, std::optional<SentScan> scan, std::int64_t now_ns);

  [[nodiscard]] EmulatedScans& source() const { return source_; }

 private:
  struct LaterBytes {
    std::string bytes;
    std::int64_t due_ns = 0;
  };

  void damage(std::string& bytes, std::int64_t now_ns);
  void garble(std::string& bytes);
  void follow_faults(std::int64_t now_ns);

  EmulatedScans& source_;
  EmulatedLrfOptions options_;
  Rng rng_;
  std::vector<SentBytes> output_;
  std::deque<LaterBytes> later_;
  std::optional<std::int64_t> origin_ns_;  ///< host time of the source's 0
  std::int64_t next_piece_ = 0;            ///< the first one that isn't due yet
  int line_baud_ = 0;
  bool was_rebooted_ = false;
  bool has_power_ = true;
  double drift_ppm_ = 0.0;
};

}  // namespace odoless
