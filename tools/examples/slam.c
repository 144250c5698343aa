/* The path and the map's size, in C, of lines of scans: slam < SCANS.csv. A line is
 * scan,STAMP_S,START_ANGLE_RAD,ANGLE_STEP_RAD,,RANGE_M,... */

#include <math.h>
#include <odoless.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { kLineMost = 1 << 20, kBeamsMost = 16384 };

static int failed(void) {
  fprintf(stderr, "slam: %s\n", odoless_last_error());
  return EXIT_FAILURE;
}

static void add(odoless_slam* slam, char* line) {
  static float ranges_m[kBeamsMost];
  double head[4] = {0.0}; /* stamp, start angle, angle step, beam period */
  size_t count = 0;
  int field = 0;
  for (char* at = strchr(line, ','); at != NULL && count < kBeamsMost; at = strchr(at + 1, ','), ++field) {
    if (field < 4) {
      head[field] = field == 0 ? strtod(at + 1, NULL) : strtof(at + 1, NULL); /* angles as logs have them */
    } else {
      ranges_m[count++] = strtof(at + 1, NULL);
    }
  }
  const odoless_scan scan = {llround(1e9 * head[0]), head[1], head[2], ranges_m, count};
  if (odoless_add_scan(slam, &scan) != ODOLESS_OK) {
    fprintf(stderr, "left out: %s\n", odoless_last_error());
  }
}

int main(void) {
  static char line[kLineMost];
  odoless_slam* slam = NULL;
  if (odoless_create(NULL, 1, &slam) != ODOLESS_OK) {
    return failed();
  }
  while (fgets(line, sizeof line, stdin) != NULL) {
    add(slam, line);
  }
  odoless_grid grid;
  size_t count = 0;
  odoless_finish(slam);
  odoless_get_trajectory(slam, NULL, 0, &count);
  odoless_pose* poses = calloc(count, sizeof *poses);
  if (poses == NULL || odoless_get_trajectory(slam, poses, count, &count) != ODOLESS_OK) {
    return failed();
  }
  for (size_t i = 0; i < count; ++i) {
    printf("%.6f %.6f %.6f %.9f\n", 1e-9 * (double)poses[i].stamp_ns, poses[i].x_m, poses[i].y_m, poses[i].yaw_rad);
  }
  odoless_get_map(slam, NULL, 0, &grid);
  printf("map: %zu x %zu cells of %g m\n", grid.width_cells, grid.height_cells, grid.resolution_m);
  free(poses);
  odoless_destroy(slam);
  return EXIT_SUCCESS;
}
