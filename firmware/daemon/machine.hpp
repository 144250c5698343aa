#pragma once

#include <memory>
#include <vector>

#include "firmware/daemon/daemon.hpp"
#include "firmware/gpio/gpio_thread.hpp"
#include "firmware/pipeline/pipeline.hpp"
#include "firmware/publisher/publisher.hpp"
#include "firmware/sources/lrf_source.hpp"
#include "firmware/sources/tilt_source.hpp"
#include "firmware/stages/filter_stage.hpp"
#include "firmware/stages/matcher_stage.hpp"
#include "firmware/threads/filter_intake.hpp"
#include "firmware/threads/filter_loop.hpp"
#include "firmware/threads/matcher_loop.hpp"
#include "firmware/threads/sensor_loop.hpp"
#include "rt/real_time_thread.hpp"

namespace odoless {

/// All parts of a daemon, made of its configuration and put together; nothing runs before `start`.
///
/// Thread: that of the supervisor.
class Machine {
 public:
  explicit Machine(DaemonOptions& options);

  /// @return  What is wrong with it, for a person, or nothing: an LCM address, a source that cannot be opened.
  [[nodiscard]] std::string open();

  /// Starts the real-time threads. @return 0, or the errno for which one cannot run.
  [[nodiscard]] int start(bool enforce);
  /// Asks the stages to drain and waits for them; false if they don't within the time.
  [[nodiscard]] bool stop(std::int64_t patience_ns);

  /// The running stage that has done no round since the last call: its name, or null where all have.
  [[nodiscard]] const char* silent_stage();
  /// Whether all stages have ended by themselves.
  [[nodiscard]] bool has_ended() const;
  /// errno where a thread was refused its priority or processor; 0: none was.
  [[nodiscard]] int scheduling_error() const;

  [[nodiscard]] DaemonResult result();

  [[nodiscard]] Pipeline& pipeline() { return pipeline_; }
  [[nodiscard]] Publisher& publisher() { return publisher_; }
  [[nodiscard]] LineHandover& line() { return line_; }
  [[nodiscard]] bool reads_laser() const { return reads_laser_; }
  /// What GPIO says and is told; where there is none, nothing is ever stopped.
  [[nodiscard]] GpioSignals& gpio() { return gpio_signals_; }
  [[nodiscard]] LineHandover& tilt_line() { return tilt_line_; }
  /// Null: there is none.
  [[nodiscard]] TiltSource* tilt() { return tilt_.get(); }
  [[nodiscard]] const Clock& clock() const { return clock_; }

 private:
  [[nodiscard]] std::unique_ptr<ScanSource> make_source(DaemonOptions& options);
  [[nodiscard]] std::unique_ptr<Intake> make_intake(const DaemonOptions& options);

  MonotonicClock clock_;
  StageSet stages_;
  CloudFormat cloud_format_;
  Pipeline pipeline_;
  LineHandover line_;
  GpioSignals gpio_signals_;
  LineHandover tilt_line_;
  bool reads_laser_ = false;
  std::unique_ptr<ScanSource> source_;
  std::unique_ptr<TiltSource> tilt_;
  std::unique_ptr<Intake> intake_;
  std::unique_ptr<MatcherStage> matcher_;
  std::unique_ptr<FilterStage> filter_;
  Publisher publisher_;
  std::unique_ptr<SensorLoop> sensor_loop_;
  std::unique_ptr<MatcherLoop> matcher_loop_;
  std::unique_ptr<FilterLoop> filter_loop_;
  std::unique_ptr<GpioThread> gpio_thread_;
  RealTimeThread sensor_thread_;
  RealTimeThread matcher_thread_;
  RealTimeThread filter_thread_;
  std::array<std::uint64_t, kStages> heartbeats_{};
  std::int64_t start_ns_ = 0;
};

}  // namespace odoless
