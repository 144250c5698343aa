#pragma once

#include <string>

#include "tools/fault_campaign/faults.hpp"
#include "tools/fault_campaign/judge.hpp"
#include "tools/fault_campaign/watched_chain.hpp"

namespace odoless::campaign {

/// A line per observation, as CSV.
struct Trace {
  static constexpr const char* kHeader =
      "time_s,event,state,reasons,confidence,error_m,error_deg,fit,tracking,updated,found,age_s,stamp_s,x_m,y_m,yaw_"
      "deg,"
      "true_x_m,true_y_m,true_yaw_deg\n";
  std::string text{};
};

/// The daemon on a stream of scans, watched. A copy goes on from where the original was, on its own.
class Run {
 public:
  /// @param drive  Must outlive the run and its copies.
  Run(const Scenario& scenario, const Drive& drive);

  /// Takes what arrives before that time and was not there before. 10 times a second it asks the daemon how it is, as
  /// it publishes that.
  void advance(const ScanStream& stream, double until_s);
  /// From now on another scenario counts, with which this one was the same until now: its fault, and its verdict. The
  /// truth is brought in line with the map as it is now, whose first metres may be off of the rest.
  void change(const Scenario& scenario);
  /// Writes down what is seen from now on.
  void trace_to(Trace* trace) { trace_ = trace; }

  [[nodiscard]] Verdict verdict() const { return judge_.verdict(); }
  /// How far the pose of the last scan was off.
  [[nodiscard]] double last_error_m() const { return last_error_m_; }
  /// Where the map has the robot then, if all is right.
  [[nodiscard]] Pose2 true_map_T_scan(double true_s) const {
    return start_T_map_.inverse() * drive_->start_T_robot(true_s);
  }
  [[nodiscard]] WatchedChain& chain() { return chain_; }

 private:
  void take(const ScanStream& stream, const SentScan& scan);
  void tick(double time_s);
  /// map_T_scan against the truth: of the scan's time, or of now where no scan came just now and the last one is old.
  [[nodiscard]] Pose2 error(double time_s, bool is_scan) const;
  void observe(double time_s, const char* event, bool is_scan);
  void write_trace(const Observation& seen, const char* event, const HealthReport& report);

  static constexpr double kTick_s = 0.1;
  static constexpr double kOld_s = 0.5;  ///< SensorStage::kLate_ns: older scans say nothing about now

  const Drive* drive_;
  Standstill standstill_;
  WatchedChain chain_;
  Judge judge_;
  Pose2 start_T_map_{};  ///< the map begins at the first scan that was accepted
  bool has_map_ = false;
  std::int64_t ticks_ = 1;
  double last_true_s_ = 0.0;  ///< of the scan that the last pose belongs to
  double last_error_m_ = 0.0;
  Trace* trace_ = nullptr;
};

/// What a run came to.
struct RunResult {
  Scenario scenario{};
  Verdict verdict{};
  double cpu_s = 0.0;
};

/// Plays one scenario. @param trace  May be null.
[[nodiscard]] RunResult play(const Scenario& scenario, Trace* trace = nullptr);

}  // namespace odoless::campaign
