/* Loaded before the C library (LD_PRELOAD): reads of a serial line fail as the first byte of the file $LINE_FAULT says (I: EINTR,
 * A: EAGAIN, E: EIO; anything else: not at all). The file is mapped, so that asking it is no system call. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

static const volatile char* fault;
static ssize_t (*real_read)(int, void*, size_t);

__attribute__((constructor)) static void prepare(void) {
  const char* const path = getenv("LINE_FAULT");
  const int file = path == NULL ? -1 : open(path, O_RDONLY | O_CLOEXEC);
  void* const page = file < 0 ? MAP_FAILED : mmap(NULL, 1, PROT_READ, MAP_SHARED, file, 0);
  fault = page == MAP_FAILED ? "-" : page;
  real_read = (ssize_t(*)(int, void*, size_t))dlsym(RTLD_NEXT, "read");
}

ssize_t read(int descriptor, void* bytes, size_t size) {
  const int error = *fault == 'I' ? EINTR : *fault == 'A' ? EAGAIN : *fault == 'E' ? EIO : 0;
  struct stat kind;
  if (error != 0 && fstat(descriptor, &kind) == 0 && S_ISCHR(kind.st_mode) && isatty(descriptor)) {
    errno = error;
    return -1;
  }
  return real_read(descriptor, bytes, size);
}
