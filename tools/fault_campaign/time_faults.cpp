#include <algorithm>
#include <cmath>

#include "core/base/rng.hpp"
#include "tools/fault_campaign/faults.hpp"

namespace odoless::campaign {
namespace {

constexpr std::uint64_t kTimeStream = 42;
constexpr std::int64_t kReadApart_ns = 2'000'000;  // scans that wait are read so soon one after the other

std::int64_t ns(double time_s) { return static_cast<std::int64_t>(time_s * 1e9); }

void miss(const Fault& fault, ScanStream& stream) {
  std::erase_if(stream.scans, [&](const SentScan& scan) { return fault.active(scan.true_s); });
}

// Gaps of one length with pauses of half to twice that in between.
void miss_again_and_again(const Fault& fault, Rng& chance, ScanStream& stream) {
  double time_s = fault.start_s;
  while (time_s < fault.end_s) {
    const Fault gap{.kind = fault.kind, .start_s = time_s, .end_s = std::min(time_s + fault.severity, fault.end_s)};
    miss(gap, stream);
    time_s += fault.severity * (1.0 + chance.uniform(0.5, 2.0));
  }
}

// A line keeps the order of what it carries.
void keep_order_of_arrival(ScanStream& stream) {
  for (std::size_t i = 1; i < stream.scans.size(); ++i) {
    std::int64_t& arrival_ns = stream.scans[i].arrival_ns;
    arrival_ns = std::max(arrival_ns, stream.scans[i - 1].arrival_ns + kReadApart_ns);
  }
}

void delay(const Fault& fault, ScanStream& stream) {
  for (SentScan& scan : stream.scans) {
    scan.arrival_ns += fault.active(scan.true_s) ? ns(fault.severity) : 0;
  }
  keep_order_of_arrival(stream);
}

// A laser without a clock: scans are stamped when they arrive.
void jitter(const Fault& fault, Rng& chance, ScanStream& stream) {
  for (SentScan& scan : stream.scans) {
    const double late_s = chance.uniform(0.0, fault.severity);
    scan.arrival_ns += fault.active(scan.true_s) ? ns(late_s) : 0;
  }
  keep_order_of_arrival(stream);
  for (SentScan& scan : stream.scans) {
    scan.stamp_ns = scan.arrival_ns;
  }
}

void hold_back_to_bursts(const Fault& fault, ScanStream& stream) {
  const auto size = static_cast<std::size_t>(fault.severity);
  const auto begin =
      std::ranges::find_if(stream.scans, [&](const SentScan& scan) { return fault.active(scan.true_s); });
  const auto end =
      std::find_if(begin, stream.scans.end(), [&](const SentScan& scan) { return !fault.active(scan.true_s); });
  const std::span<SentScan> held(begin, end);
  for (std::size_t i = 0; i < held.size(); ++i) {
    const std::size_t last = std::min((i / size + 1) * size, held.size()) - 1;
    held[i].arrival_ns = held[last].arrival_ns;
  }
  keep_order_of_arrival(stream);
  for (SentScan& scan : stream.scans) {
    scan.stamp_ns = scan.arrival_ns;
  }
}

// As in recorded logs whose order is right and whose stamps are not: some stick to the stamp before, some lie before
// it.
void waver(const Fault& fault, Rng& chance, ScanStream& stream) {
  constexpr double kStuckShare = 0.28;
  constexpr double kBackShare = 0.05;
  constexpr double kStuckMax_s = 0.01;
  constexpr double kUsualShare = 0.1;  // of the severity: the deviation of the others
  std::int64_t before_ns = 0;
  for (SentScan& scan : stream.scans) {
    const double kind = chance.uniform();
    const double share = chance.uniform();
    const double usual = chance.normal();
    if (before_ns != 0 && kind < kStuckShare) {
      scan.stamp_ns = before_ns + 1 + ns(kStuckMax_s * share);
    } else if (before_ns != 0 && kind < kStuckShare + kBackShare) {
      scan.stamp_ns = before_ns - ns(fault.severity * share);
    } else {
      scan.stamp_ns += ns(kUsualShare * fault.severity * usual);
    }
    before_ns = scan.stamp_ns;
  }
}

void jump(const Fault& fault, ScanStream& stream) {
  for (SentScan& scan : stream.scans) {
    scan.stamp_ns += fault.active(scan.true_s) ? ns(fault.severity) : 0;
  }
}

// What came first waits in the buffer of the line, as much as fits, and is read when the daemon goes on.
void stand_still(const Fault& fault, ScanStream& stream) {
  int left = static_cast<int>(fault.severity);
  std::erase_if(stream.scans, [&](const SentScan& scan) { return fault.active(scan.true_s) && left-- <= 0; });
  for (SentScan& scan : stream.scans) {
    scan.arrival_ns = fault.active(scan.true_s) ? host_ns(fault.end_s) : scan.arrival_ns;
  }
  keep_order_of_arrival(stream);
  for (SentScan& scan : stream.scans) {
    scan.stamp_ns = fault.variant == 1 ? scan.arrival_ns : scan.stamp_ns;
  }
}

}  // namespace

void apply_to_times(const Scenario& scenario, ScanStream& stream) {
  const Fault& fault = scenario.fault;
  Rng chance(scenario.seed, kTimeStream);
  switch (fault.kind) {
    case FaultKind::kSilence:
      return miss(fault, stream);
    case FaultKind::kGaps:
      return miss_again_and_again(fault, chance, stream);
    case FaultKind::kDelay:
      return delay(fault, stream);
    case FaultKind::kJitter:
      return jitter(fault, chance, stream);
    case FaultKind::kBursts:
      return hold_back_to_bursts(fault, stream);
    case FaultKind::kWavering:
      return waver(fault, chance, stream);
    case FaultKind::kJumping:
      return jump(fault, stream);
    case FaultKind::kProcessStop:
      return stand_still(fault, stream);
    case FaultKind::kSymmetric:
      return fault.variant == 0 ? miss(fault, stream) : void();
    case FaultKind::kCorridor:
      return fault.variant == 1 ? miss(fault, stream) : void();
    default:
      return;
  }
}

Standstill standstill_of(const Scenario& scenario) {
  const Fault& fault = scenario.fault;
  return fault.kind == FaultKind::kProcessStop ? Standstill{fault.start_s, fault.end_s} : Standstill{};
}

}  // namespace odoless::campaign
