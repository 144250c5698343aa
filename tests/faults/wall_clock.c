/* Loaded before the C library (LD_PRELOAD): the wall clock is set forwards by an hour and back again, every third time that it is
 * read. At the end it is said how often it was read. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdatomic.h>
#include <stdio.h>
#include <sys/time.h>
#include <time.h>

static atomic_int times_read;

static time_t jump_s(void) { return atomic_fetch_add(&times_read, 1) / 3 % 2 == 0 ? 0 : 3600; }

__attribute__((destructor)) static void tell(void) {
  fprintf(stderr, "wall clock: read %d times\n", atomic_load(&times_read));
}

int clock_gettime(clockid_t clock, struct timespec* now) {
  static int (*real_gettime)(clockid_t, struct timespec*);
  if (real_gettime == NULL) {
    real_gettime = (int (*)(clockid_t, struct timespec*))dlsym(RTLD_NEXT, "clock_gettime");
  }
  const int status = real_gettime(clock, now);
  now->tv_sec += clock == CLOCK_REALTIME && status == 0 ? jump_s() : 0;
  return status;
}

time_t time(time_t* where) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (where != NULL) {
    *where = now.tv_sec;
  }
  return now.tv_sec;
}

int gettimeofday(struct timeval* restrict now, void* restrict zone) {
  struct timespec time_now;
  (void)zone;
  clock_gettime(CLOCK_REALTIME, &time_now);
  now->tv_sec = time_now.tv_sec;
  now->tv_usec = time_now.tv_nsec / 1000;
  return 0;
}
