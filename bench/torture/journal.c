// LD_PRELOAD library that records changes of files. From the record, cut.py simulates a power cut.
//
//   TORTURE_ROOT     folder whose files are recorded
//   TORTURE_JOURNAL  folder of the record: the file `events`, with one event per line, and a copy of a file
//                    for each sync of it
//
// Events: create PATH, mkdir PATH, rename FROM TO, remove PATH, symlink PATH TO, sync PATH COPY (sync of a
// file) and folder PATH (sync of a folder). Tabs separate the fields. The path of a sync is the name of the
// file at that time, from /proc/self/fd.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

static const char *root, *journal;
static int events = -1;

__attribute__((constructor)) static void begin(void) {
    char path[PATH_MAX];
    root = getenv("TORTURE_ROOT");
    journal = getenv("TORTURE_JOURNAL");
    if (!root || !journal) return;
    snprintf(path, sizeof path, "%s/events", journal);
    events = REAL(open)(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
}

/// Returns the absolute path, stored in `whole`, if it is below the root, otherwise NULL.
static const char* below(const char* path, char* whole) {
    char folder[PATH_MAX] = "";
    if (events < 0) return NULL;
    if (path[0] != '/' && !getcwd(folder, sizeof folder)) return NULL;
    const char* divided = path[0] == '/' ? "" : "/";
    if (snprintf(whole, PATH_MAX, "%s%s%s", folder, divided, path) >= PATH_MAX) return NULL;
    const size_t length = strlen(root);
    return strncmp(whole, root, length) == 0 && (whole[length] == '/' || !whole[length]) ? whole : NULL;
}

static void say(const char* what, const char* first, const char* second) {
    char line[2 * PATH_MAX + 64];
    const int length = snprintf(line, sizeof line, "%s\t%s\t%s\n", what, first, second);
    if (write(events, line, (size_t)length) != length) abort();
}

static void copy_file(const char* from, const char* to) {
    char buffer[65536];
    const int in = REAL(open)(from, O_RDONLY | O_CLOEXEC);
    const int out = REAL(open)(to, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    ssize_t count;
    while (in >= 0 && (count = read(in, buffer, sizeof buffer)) > 0)
        if (write(out, buffer, (size_t)count) != count) abort();
    if (in >= 0) close(in);
    close(out);
}

static void synced(int file) {
    static _Atomic int made;
    char link[64], name[PATH_MAX], copy[PATH_MAX], whole[PATH_MAX];
    struct stat status;
    const int before = errno;
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t length = readlink(link, name, sizeof name - 1);
    if (length > 0 && fstat(file, &status) == 0) {
        name[length] = 0;
        if (below(name, whole) && S_ISDIR(status.st_mode)) say("folder", name, "");
        if (below(name, whole) && S_ISREG(status.st_mode) && status.st_nlink > 0) {
            snprintf(copy, sizeof copy, "%s/%d.%d", journal, (int)getpid(), atomic_fetch_add(&made, 1));
            copy_file(link, copy);
            say("sync", name, copy);
        }
    }
    errno = before;
}

int fsync(int file) {
    const int result = REAL(fsync)(file);
    if (result == 0) synced(file);
    return result;
}
int fdatasync(int file) {
    const int result = REAL(fdatasync)(file);
    if (result == 0) synced(file);
    return result;
}

#define RECORDED(name, what, parameters, first, second, ...)                  \
    int name parameters {                                                     \
        char one[PATH_MAX], other[PATH_MAX];                                  \
        const int result = REAL(name)(__VA_ARGS__);                           \
        const int before = errno;                                             \
        if (result == 0 && below(first, one)) say(what, one, second);         \
        (void)other;                                                          \
        errno = before;                                                       \
        return result;                                                        \
    }
RECORDED(mkdir, "mkdir", (const char* path, mode_t mode), path, "", path, mode)
RECORDED(rmdir, "remove", (const char* path), path, "", path)
RECORDED(unlink, "remove", (const char* path), path, "", path)
RECORDED(remove, "remove", (const char* path), path, "", path)
RECORDED(symlink, "symlink", (const char* to, const char* path), path, to, to, path)
RECORDED(rename, "rename", (const char* from, const char* to), from,
         below(to, other) ? other : "", from, to)

int unlinkat(int folder, const char* path, int flags) {
    char link[64], name[PATH_MAX], whole[2 * PATH_MAX], one[PATH_MAX];
    const int result = REAL(unlinkat)(folder, path, flags);
    const int before = errno;
    if (result == 0 && path[0] != '/' && folder != AT_FDCWD) {
        snprintf(link, sizeof link, "/proc/self/fd/%d", folder);
        const ssize_t length = readlink(link, name, sizeof name - 1);
        if (length > 0) {
            name[length] = 0;
            snprintf(whole, sizeof whole, "%s/%s", name, path);
            if (strlen(whole) < PATH_MAX && below(whole, one)) say("remove", one, "");
        }
    } else if (result == 0 && below(path, one)) {
        say("remove", one, "");
    }
    errno = before;
    return result;
}

static int opened(const char* path, int flags, mode_t mode, int (*real)(const char*, int, ...)) {
    char whole[PATH_MAX];
    struct stat status;
    const int before = errno;
    const int is_new = (flags & O_CREAT) && below(path, whole) && lstat(path, &status) != 0;
    errno = before;
    const int file = real(path, flags, mode);
    if (file >= 0 && is_new) say("create", whole, "");
    return file;
}
#define MODE                         \
    mode_t mode = 0;                 \
    if (flags & O_CREAT) {           \
        va_list rest;                \
        va_start(rest, flags);       \
        mode = va_arg(rest, mode_t); \
        va_end(rest);                \
    }
int open(const char* path, int flags, ...) {
    MODE
    return opened(path, flags, mode, REAL(open));
}
int open64(const char* path, int flags, ...) {
    MODE
    return opened(path, flags, mode, REAL(open64));
}
