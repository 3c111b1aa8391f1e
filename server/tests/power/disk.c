/* A disk that fails: preloaded into a test, it stands between SQLite and the files of one folder.
 *
 *   DISK_FOLDER  files whose path begins with this are on the disk
 *   DISK_AT      the operation at which something happens, counted from 1 over writes, syncs and truncations
 *   DISK_DOES    eio | enospc | short   that operation fails, once; `forever` behind it (eio-forever): all later ones, too
 *                cut                    the power fails: of what was written since the last sync of a file, each write stays
 *                                       or goes by chance (DISK_SEED), in sectors of 512 bytes, and the process ends
 *   DISK_COUNT   file that gets the number of operations when the process ends in an orderly way
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define MOST_FILES 4096
#define SECTOR 512

struct undo { /* what a write has replaced, newest first */
    struct undo *before;
    int file;
    off_t at;
    size_t length;
    char old[];
};

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static ino_t inode_of[MOST_FILES]; /* 0: not on the disk */
static struct undo *unsynced;
static long operations;

static void *next(const char *name) { return dlsym(RTLD_NEXT, name); }

static int is_on_disk(int file) { return file >= 0 && file < MOST_FILES && inode_of[file] != 0; }

static void note_open(int file, const char *path) {
    const char *folder = getenv("DISK_FOLDER");
    struct stat found;
    if (file < 0 || file >= MOST_FILES) return;
    inode_of[file] = 0;
    /* The index of the write-ahead file is memory shared by processes, and of no use after a power failure. */
    if (folder && !strncmp(path, folder, strlen(folder)) && !strstr(path, "-shm") && !fstat(file, &found) && S_ISREG(found.st_mode))
        inode_of[file] = found.st_ino;
}

static void cut(void) {
    ssize_t (*pwrite_)(int, const void *, size_t, off_t) = next("pwrite64");
    unsigned seed = (unsigned)atoi(getenv("DISK_SEED") ? getenv("DISK_SEED") : "1");
    for (struct undo *write = unsynced; write; write = write->before)
        for (size_t sector = 0; sector < write->length; sector += SECTOR) {
            size_t length = write->length - sector < SECTOR ? write->length - sector : SECTOR;
            if (rand_r(&seed) % 2) pwrite_(write->file, write->old + sector, length, write->at + (off_t)sector);
        }
    kill(getpid(), SIGKILL);
    pause();
}

/* The number of an error, or 0; *shortened says that half of a write is done. */
static int happens(int *shortened) {
    const char *at = getenv("DISK_AT"), *does = getenv("DISK_DOES");
    long now = ++operations;
    if (!at || !does) return 0;
    if (now != atol(at) && !(strstr(does, "forever") && now > atol(at))) return 0;
    if (!strcmp(does, "cut")) cut();
    if (!strncmp(does, "short", 5)) *shortened = 1;
    return !strncmp(does, "enospc", 6) ? ENOSPC : !strncmp(does, "eio", 3) ? EIO : 0;
}

static ssize_t change(int file, const void *bytes, size_t length, off_t at) {
    ssize_t (*pread_)(int, void *, size_t, off_t) = next("pread64");
    ssize_t (*pwrite_)(int, const void *, size_t, off_t) = next("pwrite64");
    int shortened = 0, error = happens(&shortened);
    if (error) return errno = error, -1;
    if (shortened) length = length > 1 ? length / 2 : length;
    struct undo *undo = malloc(sizeof *undo + length);
    memset(undo->old, 0, length);
    pread_(file, undo->old, length, at);
    undo->before = unsynced, undo->file = dup(file), undo->at = at, undo->length = length;
    unsynced = undo;
    return pwrite_(file, bytes, length, at);
}

static ssize_t write_at(int file, const void *bytes, size_t length, off_t at) {
    ssize_t (*pwrite_)(int, const void *, size_t, off_t) = next("pwrite64");
    if (!is_on_disk(file)) return pwrite_(file, bytes, length, at);
    pthread_mutex_lock(&lock);
    ssize_t done = change(file, bytes, length, at);
    pthread_mutex_unlock(&lock);
    return done;
}

ssize_t pwrite64(int file, const void *bytes, size_t length, off_t at) { return write_at(file, bytes, length, at); }
ssize_t pwrite(int file, const void *bytes, size_t length, off_t at) { return write_at(file, bytes, length, at); }

ssize_t write(int file, const void *bytes, size_t length) {
    ssize_t (*write_)(int, const void *, size_t) = next("write");
    if (!is_on_disk(file)) return write_(file, bytes, length);
    off_t at = lseek(file, 0, SEEK_CUR);
    ssize_t done = write_at(file, bytes, length, at);
    if (done > 0) lseek(file, at + done, SEEK_SET);
    return done;
}

static int synced(int file, const char *name) {
    int (*sync_)(int) = next(name);
    if (!is_on_disk(file)) return sync_(file);
    pthread_mutex_lock(&lock);
    int shortened = 0, error = happens(&shortened);
    for (struct undo **link = &unsynced; !error && *link;) {
        struct undo *write = *link;
        struct stat of_write, of_file;
        if (!fstat(write->file, &of_write) && !fstat(file, &of_file) && of_write.st_ino == of_file.st_ino) {
            *link = write->before;
            close(write->file);
            free(write);
        } else {
            link = &write->before;
        }
    }
    pthread_mutex_unlock(&lock);
    if (error) return errno = error, -1;
    return sync_(file);
}

int fsync(int file) { return synced(file, "fsync"); }
int fdatasync(int file) { return synced(file, "fdatasync"); }

static int truncated(int file, off_t length) {
    int (*truncate_)(int, off_t) = next("ftruncate64");
    int shortened = 0, error = is_on_disk(file) ? happens(&shortened) : 0;
    if (error) return errno = error, -1;
    return truncate_(file, length);
}

int ftruncate64(int file, off_t length) { return truncated(file, length); }
int ftruncate(int file, off_t length) { return truncated(file, length); }

#define OPEN(NAME)                                             \
    int NAME(const char *path, int flags, ...) {               \
        int (*open_)(const char *, int, ...) = next(#NAME);    \
        va_list rest;                                          \
        va_start(rest, flags);                                 \
        int file = open_(path, flags, va_arg(rest, unsigned)); \
        va_end(rest);                                          \
        note_open(file, path);                                 \
        return file;                                           \
    }
OPEN(open)
OPEN(open64)

int close(int file) {
    int (*close_)(int) = next("close");
    if (file >= 0 && file < MOST_FILES) inode_of[file] = 0;
    return close_(file);
}

__attribute__((destructor)) static void tell(void) {
    const char *path = getenv("DISK_COUNT");
    FILE *out = path ? fopen(path, "w") : NULL;
    if (out) fprintf(out, "%ld\n", operations), fclose(out);
}
