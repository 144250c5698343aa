#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "core/geometry/pose2.hpp"
#include "core/scan/scan_time.hpp"

namespace odoless {

/// The daemon's state, best last but one: what a robot may do with its pose.
enum class HealthState : std::int8_t {
  kInit = 0,      ///< no pose yet
  kOk = 1,        ///< poses can be used
  kDegraded = 2,  ///< poses can be used with care; the reasons say what is wrong
  kLost = 3,      ///< the pose in the map is not known
  kFault = 4,     ///< there are no new poses
};

/// Why a state is not OK; bits.
enum HealthReason : std::uint32_t {
  kReasonNoScans = 1U << 0,         ///< the laser is silent
  kReasonDeviceClosed = 1U << 1,    ///< it cannot be opened
  kReasonBadScans = 1U << 2,        ///< its scans are refused
  kReasonBlind = 1U << 3,           ///< too few beams see anything
  kReasonStuck = 1U << 4,           ///< the same scan again and again
  kReasonPoorMatch = 1U << 5,       ///< scans do not fit to each other
  kReasonWeakDirection = 1U << 6,   ///< the scene does not say how far the robot went along one direction
  kReasonDiverged = 1U << 7,        ///< the scans do not fit to the map
  kReasonOverload = 1U << 8,        ///< scans or records are dropped, or updates cut short
  kReasonDeadlineMissed = 1U << 9,  ///< a stage took longer than its budget
  kReasonNotRealTime = 1U << 10,    ///< real-time scheduling or locked memory was refused
  kReasonStorage = 1U << 11,        ///< a file cannot be written
  kReasonMapFull = 1U << 12,        ///< a pool of the map or of the pose graph is full
  kReasonPublishing = 1U << 13,     ///< LCM refuses datagrams
  kReasonStageSilent = 1U << 14,    ///< a stage does not answer
  kReasonDatagramsLost = 1U << 15,  ///< the other half of the pipeline was not heard for a while
  kReasonPaused = 1U << 16,         ///< somebody asked for a pause of mapping
  kReasonStopped = 1U << 17,        ///< the emergency stop is pressed, or its line is lost: nothing moves
  kReasonGpio = 1U << 18,           ///< a GPIO line cannot be used, or the sync pulse doesn't come
  kReasonTilt = 1U << 19,           ///< the tilt servo is not there, has a fault, or doesn't move as it should
  kReasonNotLevel = 1U << 20,       ///< the laser's plane is not level
  kReasonCloudFull = 1U << 21,      ///< the 3D map has no room for what is seen: what it has stays
  kReasonBadTilt = 1U << 22,        ///< the tilt servo's answers are refused, or don't come
  kReasonBadMotions = 1U << 23,     ///< motions of a matcher elsewhere are refused: forged, or of another clock
  kReasonNotAuthentic = 1U << 24,   ///< messages are refused that are not of who has the key, or not of now
  kReasonSweep = 1U << 25,          ///< the laser sweeps, as it was told: poses come when it passes the level
  kReasonNotInWorld = 1U << 26,     ///< it is not known for sure yet where the robot is in the world that is continued
  kReasonDrift = 1U << 27,          ///< the map may have drifted here: no loop closure holds it
};

/// The scan source since start. Rates and ages are taken at the time of the report.
struct SourceHealth {
  double age_s = 0.0;
  double rate_hz = 0.0;
  std::int64_t accepted = 0;
  std::int64_t rejected = 0;  ///< malformed, or refused by the scan frame
  std::int64_t late = 0;
  std::int64_t duplicate = 0;     ///< a stamp that was there before; refused
  std::int64_t out_of_order = 0;  ///< a stamp older than the one before: refused of a live source, else timed anew
  std::int64_t resyncs = 0;       ///< bytes were skipped to find the next frame
  std::int64_t dropped = 0;       ///< evicted because the matcher was busy
  std::int64_t reconnects = 0;
  std::int64_t datagrams_lost = 0;
  ScanTimeFindings times{};          ///< what the stamps of the accepted scans were like
  std::int64_t motions_refused = 0;  ///< of a matcher elsewhere; not counted in rejected
  std::int64_t forged = 0;           ///< messages that are not of who has the key; not counted in rejected
  std::int64_t replayed = 0;         ///< of who has the key, but not new; not counted in rejected
};

/// A round of a stage: when it was by CLOCK_MONOTONIC, as in the kernel's own records, and its CPU time.
struct RoundTime {
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;
  std::int64_t cpu_ns = 0;
};
/// Those that took most CPU time since start, in no order; unused: all 0.
using LongestRounds = std::array<RoundTime, 16>;

/// CPU time of a stage per scan since start.
struct StageHealth {
  std::int64_t scans = 0;
  double p50_ms = 0.0;
  double p99_ms = 0.0;
  double max_ms = 0.0;
  LongestRounds longest{};
  double budget_ms = 0.0;  ///< a round that takes longer misses its deadline
  std::int64_t deadline_misses = 0;
};

/// The 3D map since start.
struct CloudHealth {
  std::int64_t points = 0;          ///< one per voxel
  double used = 0.0;                ///< share of its memory in use, 0 to 1
  std::int64_t refused = 0;         ///< returns for which it had no room
  std::int64_t scans_left_out = 0;  ///< whose poses or angles never came
};

/// Whether it is known where the robot is in the world that is continued.
enum class WorldPlaceKnown : std::uint8_t { kNo, kGuessed, kSure };

/// The pose graph of the present map.
struct GraphHealth {
  std::int64_t submaps = 0;
  std::int64_t loop_closures = 0;
  std::int64_t keyframes = 0;           ///< of the world
  double used = 0.0;                    ///< share of its fullest pool, but for what is left for a path; 1: it is full
  bool is_localising = false;           ///< the world stays as it is
  bool is_going_over = false;           ///< it will do the other
  std::int64_t keyframes_left_out = 0;  ///< since start: it was too busy for them
  Pose2 map_T_odom{};                   ///< as the graph has it
  WorldPlaceKnown place = WorldPlaceKnown::kSure;
  double undrifted = 1.0;  ///< FilterInWorld::within_ok where the robot is
  bool has_drifted = false;
};

/// The world of the file that a daemon has.
struct WorldHealth {
  std::string uuid{};
  std::int64_t revision = 0;  ///< grows with each change of the map
  bool is_read_only = false;  ///< the robot only finds its way in it
};

enum Stage : int { kSensorStage = 0, kMatcherStage = 1, kFilterStage = 2, kStages = 3 };

/// The health message's content; `firmware/messages/health_t.lcm` is the same on the wire.
struct HealthReport {
  std::int64_t stamp_ns = 0;
  HealthState state = HealthState::kInit;
  std::uint32_t reasons = 0;          ///< now; of HealthReason
  std::uint32_t latched_reasons = 0;  ///< since start
  SourceHealth lrf;
  double fitness = 0.0;
  double second_peak_ratio = 0.0;
  std::array<double, 2> information_1_m2{};
  std::int32_t evaluations = 0;
  bool deadline_hit = false;
  double effective_particles = 0.0;
  std::int32_t particles = 0;
  double position_sd_m = 0.0;
  double yaw_sd_rad = 0.0;
  double pose_probability = 1.0;  ///< that the pose is right within 0.5 m and 5 deg
  std::array<StageHealth, kStages> stages{};
  std::int64_t page_faults = 0;  ///< of the real-time threads since READY
  std::int64_t allocations = 0;  ///< of the real-time threads since READY; -1: nobody counts
  std::int32_t scan_queue_high_water = 0;
  std::int32_t motion_queue_high_water = 0;
  std::int64_t updates_cut = 0;      ///< of the filter, ended by their deadline
  double map_pool_used = 0.0;        ///< share of the map's pool in use, 0 to 1
  std::int64_t records_dropped = 0;  ///< between the real-time threads and the publisher
  std::int64_t publish_errors = 0;
  double checkpoint_age_s = -1.0;      ///< -1: there is none
  std::int32_t storage_error = 0;      ///< errno of the last failure, 0: none
  std::optional<CloudHealth> cloud{};  ///< none: there is no 3D map
  std::optional<GraphHealth> graph{};  ///< none: there is no pose graph
  std::optional<WorldHealth> world{};  ///< none: there is no world file
  std::int64_t scans_not_level = 0;    ///< that 2D SLAM was not given, for the laser was tilted
};

}  // namespace odoless
