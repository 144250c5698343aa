#pragma once

#include <memory>
#include <vector>

#include "firmware/daemon/daemon.hpp"
#include "firmware/daemon/stage_watch.hpp"
#include "firmware/daemon/start_up.hpp"
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

/// Of the ordinary threads that publish and save.
inline constexpr std::size_t kPublisherStack_bytes = std::size_t{2} << 20;

/// All parts of a daemon, made of its configuration and put together; nothing runs before `start`.
///
/// Thread: that of the supervisor.
class Machine {
 public:
  explicit Machine(DaemonOptions& options);
  /// Ends what still runs, and the process, at once, where that does not end.
  ~Machine();
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  /// Opens LCM. @return  What is wrong with it: an address that makes no sense, a network that is not there to receive.
  [[nodiscard]] Lack open();

  /// Starts the real-time threads. @return 0, or the errno for which one cannot run.
  [[nodiscard]] int start(bool enforce);
  /// Ends the stages: they drain, and leave what still waits after `kDrain_ns`. False if one has not answered for
  /// `kEnd_ns`, as a StageWatch has it: what the publisher knows can still be saved then.
  [[nodiscard]] bool stop();
  static constexpr std::int64_t kDrain_ns = 700'000'000;
  static constexpr std::int64_t kEnd_ns = 2'000'000'000;

  /// Threads that run in a machine with this configuration, those that publish and save included.
  [[nodiscard]] int threads() const;
  /// Cells of the map that is saved at the end.
  [[nodiscard]] std::size_t map_cells() const;

  /// The stages that run here, once started.
  [[nodiscard]] std::vector<WatchedStage> watched_stages() const;
  /// Whether all stages have ended by themselves.
  [[nodiscard]] bool has_ended() const;
  /// errno where a thread was refused its priority or processor; 0: none was.
  [[nodiscard]] int scheduling_error() const;

  /// All that there is to be saved. @param is_last  The stages have been stopped. Thread: any, one at a time.
  [[nodiscard]] DaemonResult result(bool is_last);

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
  void take_last(DaemonResult& result);
  [[nodiscard]] bool is_running() const;
  void wake_all() const;
  [[nodiscard]] std::unique_ptr<ScanSource> make_source(DaemonOptions& options);
  [[nodiscard]] std::unique_ptr<Intake> make_intake(const DaemonOptions& options);

  MonotonicClock clock_;
  StageSet stages_;
  CloudFormat cloud_format_;
  LaserPlace laser_;
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
  std::int64_t start_ns_ = 0;
};

}  // namespace odoless
