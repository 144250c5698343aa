/* What each call of the C library says to what is wrong. Ends with 0 where all is as odoless.h has it. */

#include <math.h>
#include <odoless.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { kBeams = 180 };
static const double kStep_rad = 2.0 * 3.14159265 / kBeams;

static void expect(odoless_status wanted, odoless_status found, const char* sentence) {
  if (found != wanted || (wanted != ODOLESS_OK && strstr(odoless_last_error(), sentence) == NULL)) {
    fprintf(stderr, "status %d instead of %d, \"%s\" for \"%s\"\n", found, wanted, odoless_last_error(), sentence);
    exit(1);
  }
}

static void expect_true(int is_so, const char* what) {
  if (!is_so) {
    fprintf(stderr, "not so: %s\n", what);
    exit(1);
  }
}

/* From the middle of a room of 6 m by 4 m. */
static void look(float* ranges_m) {
  for (int i = 0; i < kBeams; ++i) {
    const double angle = -3.14159265 + 2.0 * 3.14159265 * i / kBeams;
    ranges_m[i] = (float)fmin(3.0 / fabs(cos(angle)), 2.0 / fabs(sin(angle)));
  }
  ranges_m[0] = INFINITY;
  ranges_m[1] = NAN;
}

static odoless_status add(odoless_slam* slam, const float* ranges_m, double step_rad, int64_t stamp_ns) {
  const odoless_scan scan = {stamp_ns, -3.14159265, step_rad, ranges_m, kBeams};
  return odoless_add_scan(slam, &scan);
}

static void check_creation(void) {
  odoless_slam* slam = NULL;
  expect(ODOLESS_BAD_ARGUMENT, odoless_create(NULL, 1, NULL), "slam must not be null");
  expect(ODOLESS_BAD_CONFIG, odoless_create("[scan]\nrange_max_m = 900\n", 1, &slam),
         "configuration:2: key 'scan.range_max_m' = 900");
  expect(ODOLESS_BAD_CONFIG, odoless_create("what\n", 1, &slam), "configuration:1");
  expect_true(slam == NULL, "nothing is made");
  odoless_destroy(NULL);
}

static void check_scans(odoless_slam* slam, const float* ranges_m) {
  odoless_estimate estimate;
  expect(ODOLESS_NOT_YET, odoless_get_estimate(slam, &estimate), "no scan was taken");
  expect(ODOLESS_BAD_ARGUMENT, add(slam, NULL, 0.1, 0), "must not be null");
  expect(ODOLESS_BAD_ARGUMENT, add(slam, ranges_m, NAN, 0), "within +-100 rad");
  expect(ODOLESS_BAD_ARGUMENT, add(slam, ranges_m, 0.1, INT64_MIN), "within +-4e18");
  expect(ODOLESS_BAD_SCAN, add(slam, ranges_m, 0.0, 0), "angle step of 0");
  for (int i = 0; i < 20; ++i) {
    expect(ODOLESS_OK, add(slam, ranges_m, kStep_rad, 100000000LL * i), "");
  }
  expect(ODOLESS_BAD_SCAN, add(slam, ranges_m, kStep_rad, 1900000000LL), "already");
  expect(ODOLESS_OK, odoless_get_estimate(slam, &estimate), "");
  expect_true(estimate.pose.stamp_ns == 1900000000LL && hypot(estimate.pose.x_m, estimate.pose.y_m) < 0.05,
              "it stands");
  expect_true(estimate.state == ODOLESS_STATE_OK && estimate.probability > 0.9, "it knows where it is");
  for (int i = 0; i < 9; ++i) {
    expect_true(fabs(estimate.covariance[i] - estimate.covariance[3 * (i % 3) + i / 3]) < 1e-12,
                "covariance is symmetric");
  }
  expect_true(estimate.covariance[0] >= 0.0 && estimate.covariance[0] < 0.01, "position is known");
}

static void check_results(odoless_slam* slam, const float* ranges_m) {
  size_t count = 0;
  odoless_grid grid;
  odoless_pose poses[20];
  expect(ODOLESS_OK, odoless_finish(slam), "");
  expect(ODOLESS_OK, odoless_finish(slam), "");
  expect(ODOLESS_FINISHED, add(slam, ranges_m, 0.1, 9000000000LL), "after odoless_finish");
  expect(ODOLESS_TOO_SMALL, odoless_get_trajectory(slam, poses, 19, &count), "more poses");
  expect_true(count == 20, "count is told");
  expect(ODOLESS_OK, odoless_get_trajectory(slam, poses, 20, &count), "");
  expect_true(poses[19].stamp_ns == 1900000000LL, "stamps are those of the scans");
  expect(ODOLESS_BAD_ARGUMENT, odoless_get_trajectory(slam, NULL, 20, &count), "must not be null");
  expect(ODOLESS_TOO_SMALL, odoless_get_map(slam, NULL, 0, &grid), "more cells");
  const size_t size = grid.width_cells * grid.height_cells;
  int8_t* cells = malloc(size);
  expect(ODOLESS_OK, odoless_get_map(slam, cells, size, &grid), "");
  const size_t column = (size_t)((0.0 - grid.origin_x_m) / grid.resolution_m);
  const size_t row = (size_t)((0.0 - grid.origin_y_m) / grid.resolution_m);
  expect_true(cells[row * grid.width_cells + column] >= 0 && cells[row * grid.width_cells + column] < 20,
              "the middle is free");
  expect_true(fabs((double)grid.width_cells * grid.resolution_m - 6.0) < 0.5, "the room is 6 m wide");
  free(cells);
}

int main(void) {
  float ranges_m[kBeams];
  odoless_slam* slam = NULL;
  expect_true(odoless_last_error()[0] == '\0', "no error so far");
  look(ranges_m);
  check_creation();
  expect(ODOLESS_OK, odoless_create("[slam.low]\nparticles = 20\n", 1, &slam), "");
  check_scans(slam, ranges_m);
  check_results(slam, ranges_m);
  odoless_destroy(slam);
  return 0;
}
