// A disk that answers no more while the file of VOXTOUCH_TEST_DISK_HANGS is there: writes to bags
// wait. Loaded with LD_PRELOAD.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void wait_while_hung(int file) {
  const char* flag = getenv("VOXTOUCH_TEST_DISK_HANGS");
  char link[64], name[4096];
  if (!flag)
    return;
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t size = readlink(link, name, sizeof name - 1);
  if (size < 0)
    return;
  name[size] = '\0';
  if (!strstr(name, ".mcap") && !strstr(name, ".db3"))
    return;
  while (access(flag, F_OK) == 0)
    usleep(5000);
}

ssize_t write(int file, const void* bytes, size_t size) {
  static ssize_t (*real)(int, const void*, size_t);
  if (!real)
    *(void**)&real = dlsym(RTLD_NEXT, "write");
  wait_while_hung(file);
  return real(file, bytes, size);
}

ssize_t pwrite64(int file, const void* bytes, size_t size, off64_t at) {
  static ssize_t (*real)(int, const void*, size_t, off64_t);
  if (!real)
    *(void**)&real = dlsym(RTLD_NEXT, "pwrite64");
  wait_while_hung(file);
  return real(file, bytes, size, at);
}

ssize_t pwrite(int file, const void* bytes, size_t size, off_t at) {
  return pwrite64(file, bytes, size, at);
}
