/* A disk that runs full, for tests: preloaded into a program (LD_PRELOAD), it counts the bytes that the program and its children write
   to regular files; once SMALL_DISK_COUNTER, a file that holds one 64-bit number, has counted down to zero, writing fails as on a full
   disk: what still fits is written, then ENOSPC. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

static _Atomic int64_t *left_bytes;

__attribute__((constructor)) static void open_counter(void) {
  const char *path = getenv("SMALL_DISK_COUNTER");
  const int file = path ? open(path, O_RDWR | O_CLOEXEC) : -1;
  if (file < 0) return;
  void *memory = mmap(0, sizeof *left_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (memory != MAP_FAILED) left_bytes = memory;
  close(file);
}

/* Number of bytes that may be written; -1 with errno when it is 0. */
static ssize_t allowed(int file, size_t bytes) {
  struct stat about;
  /* Messages are not limited, even if a test writes them to a file. */
  if (file == STDOUT_FILENO || file == STDERR_FILENO) return (ssize_t)bytes;
  if (!left_bytes || bytes == 0 || fstat(file, &about) != 0 || !S_ISREG(about.st_mode)) return (ssize_t)bytes;
  const int64_t before = atomic_fetch_sub(left_bytes, (int64_t)bytes);
  if (before >= (int64_t)bytes) return (ssize_t)bytes;
  if (before > 0) return before;
  errno = ENOSPC;
  return -1;
}

ssize_t write(int file, const void *data, size_t bytes) {
  const ssize_t count = allowed(file, bytes);
  return count < 0 ? -1 : ((ssize_t(*)(int, const void *, size_t))dlsym(RTLD_NEXT, "write"))(file, data, (size_t)count);
}

ssize_t pwrite(int file, const void *data, size_t bytes, off_t at) {
  const ssize_t count = allowed(file, bytes);
  return count < 0 ? -1
                   : ((ssize_t(*)(int, const void *, size_t, off_t))dlsym(RTLD_NEXT, "pwrite"))(file, data, (size_t)count, at);
}

ssize_t pwrite64(int file, const void *data, size_t bytes, off64_t at) {
  const ssize_t count = allowed(file, bytes);
  return count < 0 ? -1
                   : ((ssize_t(*)(int, const void *, size_t, off64_t))dlsym(RTLD_NEXT, "pwrite64"))(file, data, (size_t)count, at);
}

ssize_t writev(int file, const struct iovec *parts, int count) {
  size_t bytes = 0;
  for (int i = 0; i < count; ++i) bytes += parts[i].iov_len;
  const ssize_t fits = allowed(file, bytes);
  if (fits < 0) return -1;
  if ((size_t)fits < bytes) { /* nothing of it: the caller sees a full disk at once */
    errno = ENOSPC;
    return -1;
  }
  return ((ssize_t(*)(int, const struct iovec *, int))dlsym(RTLD_NEXT, "writev"))(file, parts, count);
}
