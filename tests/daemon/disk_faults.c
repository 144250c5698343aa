/* Loaded before the C library (LD_PRELOAD): a disk that does what the file $DISK_FAULT says, as long as it does. "slow" and "broken"
 * hold where any file is synced, "slow", "full" and "read-only" where a page is written to one whose path has $DISK_FAULT_AT in it. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { kWord_bytes = 16 };

static void read_fault(char word[kWord_bytes]) {
  FILE* const file = fopen(getenv("DISK_FAULT"), "r");
  word[0] = '\0';
  if (file != NULL) {
    if (fgets(word, kWord_bytes, file) == NULL) {
      word[0] = '\0';
    }
    fclose(file);
  }
}

static int sync_as(const char* name, int descriptor) {
  int (*const real)(int) = (int (*)(int))dlsym(RTLD_NEXT, name);
  char word[kWord_bytes];
  read_fault(word);
  if (strcmp(word, "slow") == 0) {
    usleep(300000);
  }
  if (strcmp(word, "broken") == 0) {
    errno = EIO;
    return -1;
  }
  return real(descriptor);
}

static int is_concerned(int descriptor) {
  const char* const part = getenv("DISK_FAULT_AT");
  char link[64];
  char path[PATH_MAX + 1] = "";
  snprintf(link, sizeof(link), "/proc/self/fd/%d", descriptor);
  return part != NULL && readlink(link, path, PATH_MAX) > 0 && strstr(path, part) != NULL;
}

int fsync(int descriptor) { return sync_as("fsync", descriptor); }

int fdatasync(int descriptor) { return sync_as("fdatasync", descriptor); }

/* How SQLite writes a page. */
ssize_t pwrite64(int descriptor, const void* data, size_t size, off64_t at) {
  ssize_t (*const real)(int, const void*, size_t, off64_t) =
      (ssize_t(*)(int, const void*, size_t, off64_t))dlsym(RTLD_NEXT, "pwrite64");
  char word[kWord_bytes] = "";
  if (is_concerned(descriptor)) {
    read_fault(word);
  }
  if (strcmp(word, "full") == 0 || strcmp(word, "read-only") == 0) {
    errno = strcmp(word, "full") == 0 ? ENOSPC : EROFS;
    return -1;
  }
  if (strcmp(word, "slow") == 0) {
    usleep(5000);
  }
  return real(descriptor, data, size, at);
}
