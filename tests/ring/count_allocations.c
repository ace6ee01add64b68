/* Preloaded into a node: counts malloc, calloc, realloc and free of the main thread (the loop)
 * during a window of time. Calls of Cyclone DDS's library are counted apart from all others.
 * Writes "ours N dds M" at exit.
 *   VOXTOUCH_COUNT_FILE  output file
 *   VOXTOUCH_COUNT_FROM_S, VOXTOUCH_COUNT_TO_S  window, seconds after the start */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

extern void* __libc_malloc(size_t);
extern void* __libc_calloc(size_t, size_t);
extern void* __libc_realloc(void*, size_t);
extern void __libc_free(void*);

static double start_s, from_s = 1e9, to_s = 1e9;
static atomic_long ours, dds;
static uintptr_t dds_low, dds_high;

static double now_s(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void count(void* caller) {
  if (from_s > 1e8 || syscall(SYS_gettid) != getpid())
    return;
  const double t = now_s() - start_s;
  if (t < from_s || t > to_s)
    return;
  const uintptr_t c = (uintptr_t)caller;
  atomic_fetch_add(c >= dds_low && c < dds_high ? &dds : &ours, 1);
}

void* malloc(size_t n) {
  count(__builtin_return_address(0));
  return __libc_malloc(n);
}
void* calloc(size_t n, size_t m) {
  count(__builtin_return_address(0));
  return __libc_calloc(n, m);
}
void* realloc(void* p, size_t n) {
  count(__builtin_return_address(0));
  return __libc_realloc(p, n);
}

/* Freeing a scene in the loop would cost more than building a message: it counts too. */
void free(void* p) {
  if (p)
    count(__builtin_return_address(0));
  __libc_free(p);
}

/* The address range of libddsc, from the kernel's own table. */
static void find_dds(void) {
  char line[512];
  FILE* maps = fopen("/proc/self/maps", "r");
  if (!maps)
    return;
  while (fgets(line, sizeof line, maps)) {
    unsigned long low, high;
    if (!strstr(line, "libddsc.so") || sscanf(line, "%lx-%lx", &low, &high) != 2)
      continue;
    if (!dds_low || low < dds_low)
      dds_low = low;
    if (high > dds_high)
      dds_high = high;
  }
  fclose(maps);
}

__attribute__((constructor)) static void begin(void) {
  find_dds();
  start_s = now_s();
  const char *from = getenv("VOXTOUCH_COUNT_FROM_S"), *to = getenv("VOXTOUCH_COUNT_TO_S");
  if (from && to)
    to_s = atof(to), from_s = atof(from);
}

__attribute__((destructor)) static void end(void) {
  const char* name = getenv("VOXTOUCH_COUNT_FILE");
  FILE* out = name ? fopen(name, "w") : NULL;
  if (!out)
    return;
  fprintf(out, "ours %ld dds %ld\n", atomic_load(&ours), atomic_load(&dds));
  fclose(out);
}
