/* Loaded before the C library (LD_PRELOAD): a disk that does what the file $DISK_FAULT says, as long as it does. "slow" and "broken"
 * hold where any file is synced, "slow", "full" and "read-only" where a page is written to one whose path has $DISK_FAULT_AT in it.
 * Of such files it keeps what was synced, too. */
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

/* The path of a file that $DISK_FAULT_AT concerns. */
static int is_concerned(int descriptor, char path[PATH_MAX]) {
  const char* const part = getenv("DISK_FAULT_AT");
  char link[64];
  snprintf(link, sizeof(link), "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, PATH_MAX - 1);
  path[length < 0 ? 0 : length] = '\0';
  return part != NULL && strstr(path, part) != NULL;
}

/* What a power cut leaves of a file is beside it, as PATH.synced. Read by this descriptor: another one would take the locks of
 * SQLite with it when it is closed. */
static void keep_synced(int descriptor) {
  char path[PATH_MAX];
  char made[PATH_MAX + 8];
  char synced[PATH_MAX + 8];
  char bytes[4096];
  if (!is_concerned(descriptor, path)) {
    return;
  }
  snprintf(made, sizeof(made), "%s.making", path);
  snprintf(synced, sizeof(synced), "%s.synced", path);
  FILE* const to = fopen(made, "wb");
  ssize_t size = 0;
  for (off_t at = 0; (size = pread(descriptor, bytes, sizeof(bytes), at)) > 0; at += size) {
    fwrite(bytes, 1, (size_t)size, to);
  }
  fclose(to);
  rename(made, synced);
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
  const int status = real(descriptor);
  if (status == 0) {
    keep_synced(descriptor);
  }
  return status;
}

int fsync(int descriptor) { return sync_as("fsync", descriptor); }

int fdatasync(int descriptor) { return sync_as("fdatasync", descriptor); }

/* How SQLite writes a page. */
ssize_t pwrite64(int descriptor, const void* data, size_t size, off64_t at) {
  ssize_t (*const real)(int, const void*, size_t, off64_t) =
      (ssize_t(*)(int, const void*, size_t, off64_t))dlsym(RTLD_NEXT, "pwrite64");
  char word[kWord_bytes] = "";
  char path[PATH_MAX];
  if (is_concerned(descriptor, path)) {
    read_fault(word);
  }
  if (strcmp(word, "full") == 0 || strcmp(word, "read-only") == 0) {
    errno = strcmp(word, "full") == 0 ? ENOSPC : EROFS;
    return -1;
  }
  if (strcmp(word, "slow") == 0) {
    usleep(1000);
  }
  return real(descriptor, data, size, at);
}
