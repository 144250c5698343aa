#include "drivers/lrf/csv/bring_up.hpp"

#include <cmath>
#include <utility>

namespace odoless::csv {
namespace {

constexpr std::int64_t kListenNs = 3'000'000'000;  ///< for two lines
constexpr int kRefusedToTell = 2;                  ///< of the first line, the beginning may be missing

}  // namespace

BringUp::BringUp(const LrfParams& params, ScanStream& stream) : BringUpSteps(params, stream) {}

void BringUp::start(std::int64_t now_ns, bool /*with_reset*/) {
  begin();
  refused_ = 0;
  last_.reset();
  wait(Step::kListen, now_ns + kListenNs);
}

void BringUp::on_line(std::string_view line, std::int64_t now_ns, LrfSink& sink) {
  const Result<ScanLine> scan = stream().read(line);
  if (!scan.ok()) {
    if (++refused_ == kRefusedToTell) {
      sink.on_event({.type = LrfEventType::kRejected, .reason = scan.error()});
    }
    last_.reset();
    return;
  }
  const std::optional<Heard> before = std::exchange(last_, Heard{scan.value(), now_ns});
  if (!before || before->line.shape != scan.value().shape) {
    return;
  }
  const std::optional<double> stamp_s = scan.value().stamp_s;
  const double since_s = stamp_s && before->line.stamp_s ? *stamp_s - *before->line.stamp_s
                                                         : static_cast<double>(now_ns - before->arrival_ns) * 1e-9;
  if (since_s <= 0.0 || since_s > static_cast<double>(kListenNs) * 1e-9) {
    return;
  }
  stream().configure(scan.value(), std::llround(since_s * 1e9));
  finish();
}

void BringUp::on_deadline(std::int64_t now_ns, LrfSink& sink) {
  tell_silence(sink);
  wait(Step::kListen, now_ns + kListenNs);
}

}  // namespace odoless::csv
