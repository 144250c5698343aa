/* Loaded before the C library (LD_PRELOAD): a disk that fails or is slow as long as the file $DISK_FAULT says so. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int fault(void) {
  char word[8] = "";
  FILE* const file = fopen(getenv("DISK_FAULT"), "r");
  if (file != NULL) {
    if (fgets(word, sizeof(word), file) == NULL) {
      word[0] = '\0';
    }
    fclose(file);
  }
  if (strncmp(word, "slow", 4) == 0) {
    usleep(300000);
  }
  return strncmp(word, "broken", 6) == 0;
}

int fsync(int descriptor) {
  int (*const real)(int) = (int (*)(int))dlsym(RTLD_NEXT, "fsync");
  if (fault()) {
    errno = EIO;
    return -1;
  }
  return real(descriptor);
}
