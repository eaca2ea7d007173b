// LD_PRELOAD library that injects faults: calls that fail or wait, and clocks that jump or run fast.
//
//   TORTURE_COUNTER   file of 8 bytes that counts the calls of all processes together
//   TORTURE_FAIL_AT   number of the first call that fails, from 1; 0 or unset: none
//   TORTURE_FAIL_FOR  number of calls that fail from there on; unset: all
//   TORTURE_ERRNO     errno of the failing calls; unset: ENOSPC
//   TORTURE_DELAY_US  microseconds that each call waits
//   TORTURE_THREADS   number of threads of a process after which pthread_create() fails with EAGAIN
//   TORTURE_BACK_S    seconds by which CLOCK_REALTIME goes back at every 20th query
//   TORTURE_RATE      factor by which CLOCK_MONOTONIC runs faster
//
// The counted calls are mkdir, symlink, rename and an open() that creates a file, and on regular files and
// folders write, pwrite, writev, ftruncate, fsync and fdatasync. Calls that stdio makes inside the C library
// cannot be intercepted.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

static _Atomic long* counter;
static long fail_at, fail_for = -1, delay, threads_left = -1, back, rate = 1;
static int fail_with = ENOSPC;

static long number(const char* name, long otherwise) {
    const char* text = getenv(name);
    return text && *text ? atol(text) : otherwise;
}

__attribute__((constructor)) static void begin(void) {
    fail_at = number("TORTURE_FAIL_AT", 0);
    fail_for = number("TORTURE_FAIL_FOR", -1);
    fail_with = (int)number("TORTURE_ERRNO", ENOSPC);
    delay = number("TORTURE_DELAY_US", 0);
    threads_left = number("TORTURE_THREADS", -1);
    back = number("TORTURE_BACK_S", 0);
    rate = number("TORTURE_RATE", 1);
    const char* path = getenv("TORTURE_COUNTER");
    const int file = path ? REAL(open)(path, O_RDWR | O_CLOEXEC) : -1;
    if (file < 0) return;
    void* memory = mmap(NULL, sizeof(long), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (memory != MAP_FAILED) counter = memory;
    close(file);
}

/// Counts and delays a call. Returns 1 and sets errno if the call must fail.
static int fails(void) {
    if (delay > 0) usleep((useconds_t)delay);
    if (!counter) return 0;
    const long at = atomic_fetch_add(counter, 1) + 1;
    if (fail_at <= 0 || at < fail_at) return 0;
    if (fail_for >= 0 && at >= fail_at + fail_for) return 0;
    errno = fail_with;
    return 1;
}

static int is_kept(int file) {
    struct stat status;
    const int before = errno;
    const int kept = file > 2 && fstat(file, &status) == 0 &&
                     (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode));
    errno = before;
    return kept;
}

#define OF_FILE(type, name, parameters, ...)             \
    type name parameters {                               \
        if (is_kept(file) && fails()) return -1;         \
        return REAL(name)(__VA_ARGS__);                  \
    }
OF_FILE(ssize_t, write, (int file, const void* bytes, size_t count), file, bytes, count)
OF_FILE(ssize_t, pwrite, (int file, const void* bytes, size_t count, off_t at), file, bytes, count, at)
OF_FILE(ssize_t, pwrite64, (int file, const void* bytes, size_t count, off64_t at), file, bytes, count, at)
OF_FILE(ssize_t, writev, (int file, const struct iovec* parts, int count), file, parts, count)
OF_FILE(int, ftruncate, (int file, off_t size), file, size)
OF_FILE(int, ftruncate64, (int file, off64_t size), file, size)
OF_FILE(int, fsync, (int file), file)
OF_FILE(int, fdatasync, (int file), file)

int rename(const char* from, const char* to) { return fails() ? -1 : REAL(rename)(from, to); }
int mkdir(const char* path, mode_t mode) { return fails() ? -1 : REAL(mkdir)(path, mode); }
int symlink(const char* to, const char* path) { return fails() ? -1 : REAL(symlink)(to, path); }

static int makes_file(const char* path, int flags) {
    struct stat status;
    const int before = errno;
    const int makes = (flags & O_CREAT) && lstat(path, &status) != 0;
    errno = before;
    return makes;
}

#define MODE                        \
    mode_t mode = 0;                \
    if (flags & O_CREAT) {          \
        va_list rest;               \
        va_start(rest, flags);      \
        mode = va_arg(rest, mode_t); \
        va_end(rest);               \
    }
int open(const char* path, int flags, ...) {
    MODE
    return makes_file(path, flags) && fails() ? -1 : REAL(open)(path, flags, mode);
}
int open64(const char* path, int flags, ...) {
    MODE
    return makes_file(path, flags) && fails() ? -1 : REAL(open64)(path, flags, mode);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*), void* argument) {
    static _Atomic long made;
    if (threads_left >= 0 && atomic_fetch_add(&made, 1) >= threads_left) return EAGAIN;
    return REAL(pthread_create)(thread, attributes, run, argument);
}

/// Returns the seconds by which CLOCK_REALTIME has gone back so far; each call counts as a query.
static long put_back(void) {
    static _Atomic long questions;
    return back == 0 ? 0 : back * (atomic_fetch_add(&questions, 1) / 20);
}
int clock_gettime(clockid_t clock, struct timespec* now) {
    static __typeof__(&clock_gettime) real;
    static _Atomic long first;
    if (!real) real = REAL(clock_gettime);
    const int result = real(clock, now);
    if (clock == CLOCK_REALTIME) now->tv_sec -= put_back();
    if (clock == CLOCK_MONOTONIC && rate > 1) {
        const long at = now->tv_sec * 1000000000L + now->tv_nsec;
        long begin = 0;
        if (atomic_compare_exchange_strong(&first, &begin, at)) begin = at;
        const long shown = begin + (at - begin) * rate;
        now->tv_sec = shown / 1000000000L;
        now->tv_nsec = shown % 1000000000L;
    }
    return result;
}
time_t time(time_t* result) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    if (result) *result = now.tv_sec;
    return now.tv_sec;
}
int gettimeofday(struct timeval* now, void* zone) {
    const int result = REAL(gettimeofday)(now, zone);
    now->tv_sec -= put_back();
    return result;
}
