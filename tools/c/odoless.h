/* odoless for C: scans in; pose, path and map out. README.md beside this file has an example.
 *
 * Units: metres, radians, nanoseconds. Frames: the map begins at the first scan; x forward, y left, angles
 * counter-clockwise. The same scans, configuration and random seed give the same numbers. Thread: a slam is used by one
 * thread at a time; several slams by several threads. Nothing here is for a real-time thread.
 */
#ifndef ODOLESS_H
#define ODOLESS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What came of a call. Of all but the first, odoless_last_error() has a sentence, and nothing has changed. */
typedef enum odoless_status {
  ODOLESS_OK = 0,
  ODOLESS_BAD_ARGUMENT = 1, /* a null pointer, or a number that cannot be */
  ODOLESS_BAD_CONFIG = 2,   /* the sentence has each problem with its line, key and what would be right */
  ODOLESS_BAD_SCAN = 3,     /* refused: too many beams, angles that cannot be, or a scan that was there already */
  ODOLESS_TOO_SMALL = 4,    /* the caller's buffer; the size that is needed was told */
  ODOLESS_NOT_YET = 5,      /* no scan was taken so far */
  ODOLESS_FINISHED = 6,     /* no scan is taken after odoless_finish */
  ODOLESS_NO_MEMORY = 7,
  ODOLESS_FAILED = 8
} odoless_status;

/* One sweep: beam i is seen at angle_min_rad + i * angle_step_rad in the laser's frame. A range that is infinite is no
 * return; one that is no number, 0 or less says nothing. The ranges are the caller's, and read during the call alone.
 */
typedef struct odoless_scan {
  int64_t stamp_ns;
  double angle_min_rad;
  double angle_step_rad;
  const float* ranges_m;
  size_t count;
} odoless_scan;

/* What the pose is taken for. */
typedef enum odoless_state {
  ODOLESS_STATE_OK = 0,       /* right within 0.5 m and 5 deg, with the probability of the configuration (0.9) */
  ODOLESS_STATE_DEGRADED = 1, /* less probable than that */
  ODOLESS_STATE_LOST = 2      /* the pose in the map is not known */
} odoless_state;

/* Of the robot in the map at the stamp of a scan. */
typedef struct odoless_pose {
  int64_t stamp_ns;
  double x_m;
  double y_m;
  double yaw_rad;
} odoless_pose;

/* The newest pose, as known now. */
typedef struct odoless_estimate {
  odoless_pose pose;
  double covariance[9]; /* over (x_m, y_m, yaw_rad), map axes, row by row */
  double probability;   /* that the pose is right within 0.5 m and 5 deg */
  odoless_state state;
} odoless_estimate;

/* Where the cells of a map lie. Cell 0 has the lowest x and y, row after row along x. */
typedef struct odoless_grid {
  double resolution_m;
  double origin_x_m; /* lower left corner of cell 0 */
  double origin_y_m;
  size_t width_cells;
  size_t height_cells;
} odoless_grid;

typedef struct odoless_slam odoless_slam;

/* What was wrong with the last call on this thread that failed; "" before. Valid until the next call. */
const char* odoless_last_error(void);

/* config_toml  The text of a configuration file as `odoless replay --config` takes one; NULL: what is built in. */
odoless_status odoless_create(const char* config_toml, uint64_t random_seed, odoless_slam** slam);
/* slam  May be NULL. */
void odoless_destroy(odoless_slam* slam);

odoless_status odoless_add_scan(odoless_slam* slam, const odoless_scan* scan);
odoless_status odoless_get_estimate(odoless_slam* slam, odoless_estimate* estimate);

/* After the last scan: closes the loops that are left, so that path and map are final. */
odoless_status odoless_finish(odoless_slam* slam);

/* A pose for each scan that was taken. count  Is told in any case; with capacity 0, poses may be NULL. */
odoless_status odoless_get_trajectory(odoless_slam* slam, odoless_pose* poses, size_t capacity, size_t* count);
/* Occupancy in percent, -1: unknown. grid  Is told in any case, width_cells * height_cells are needed; with capacity 0,
 * cells may be NULL. Draws the map anew at each call. */
odoless_status odoless_get_map(odoless_slam* slam, int8_t* cells, size_t capacity, odoless_grid* grid);

#ifdef __cplusplus
}
#endif

#endif
