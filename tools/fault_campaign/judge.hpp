#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "firmware/records/health.hpp"

namespace odoless::campaign {

/// What the daemon said at some time, and how far its pose was off.
struct Observation {
  double time_s = 0.0;
  HealthState state = HealthState::kInit;
  double error_m = 0.0;
  double error_rad = 0.0;
  bool is_scan = false;     ///< a pose was published just now
  double confidence = 0.0;  ///< the probability of being right that it said
};

inline constexpr double kWrong_m = 0.5;
inline constexpr double kSettled_m = 0.1;
inline constexpr double kWrong_rad = 0.08726646259971647;  // 5 deg

/// Whether a pose is off by more than 0.5 m or 5 deg.
[[nodiscard]] bool is_wrong(double error_m, double error_rad);
[[nodiscard]] bool is_wrong(const Pose2& pose_T_true);

/// How often poses were right of those that were said to be so with about the same probability.
struct Calibration {
  static constexpr std::size_t kBins = 10;
  struct Bin {
    std::int64_t poses = 0;
    std::int64_t right = 0;
    double said_sum = 0.0;  ///< of the probabilities
    [[nodiscard]] double said() const { return poses == 0 ? 0.0 : said_sum / static_cast<double>(poses); }
    [[nodiscard]] double share_right() const {
      return poses == 0 ? 0.0 : static_cast<double>(right) / static_cast<double>(poses);
    }
  };
  std::array<Bin, kBins> bins{};

  void add(double said, bool right);
  void add(const Calibration& other);
  /// Mean of the bins' differences between said and true, each as heavy as it has poses.
  [[nodiscard]] double error() const;
  [[nodiscard]] std::int64_t poses() const;
};

inline constexpr std::size_t kStates = 5;  ///< of HealthState

/// What became of a run.
struct Verdict {
  static constexpr double kSilentFailure_s = 1.0;

  double silent_s = 0.0;               ///< longest time of being OK and wrong at a stretch
  double silent_from_s = 0.0;          ///< when that began
  std::vector<double> said_after_s{};  ///< for each time that it became wrong and stayed so until it was said
  double recovered_after_s = std::numeric_limits<double>::infinity();  ///< after the fault: right and OK for 2 s
  double settled_after_s = std::numeric_limits<double>::infinity();    ///< the same, and within 0.10 m
  double final_error_m = 0.0;
  double final_error_rad = 0.0;
  std::array<std::int64_t, kStates> scans{};        ///< by state
  std::array<std::int64_t, kStates> right_scans{};  ///< of them
  Calibration calibration{};

  [[nodiscard]] bool failed_silently() const { return silent_s > kSilentFailure_s; }
  [[nodiscard]] std::int64_t all_scans() const;
};

/// Watches what the daemon says beside the truth.
class Judge {
 public:
  /// @param fault_end_s  From when on it can recover.
  explicit Judge(double fault_end_s) : fault_end_s_(fault_end_s) {}

  /// In the order of time.
  void add(const Observation& seen);
  [[nodiscard]] Verdict verdict() const;

 private:
  void watch_silence(const Observation& seen, bool wrong);
  void watch_saying(const Observation& seen, bool wrong);

  static constexpr double kNever_s = std::numeric_limits<double>::infinity();

  /// When something that is good began to be so for a while.
  struct Recovery {
    double good_since_s = kNever_s;
    void watch(const Observation& seen, bool good, double from_s, double& after_s);
  };

  double fault_end_s_;
  Verdict verdict_;
  double silent_since_s_ = kNever_s;
  double wrong_since_s_ = kNever_s;
  bool said_ = false;
  Recovery recovery_;
  Recovery settling_;
};

}  // namespace odoless::campaign
