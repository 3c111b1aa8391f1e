/* Every fsync takes FAULT_SYNC_S seconds for as long as the file FAULT_SYNC_WHILE exists. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>
#include <unistd.h>

static void stall(void) {
    const char *while_there = getenv("FAULT_SYNC_WHILE"), *seconds = getenv("FAULT_SYNC_S");
    if (while_there && seconds && access(while_there, F_OK) == 0) usleep((useconds_t)(atof(seconds) * 1e6));
}

int fsync(int file) {
    stall();
    return ((int (*)(int))dlsym(RTLD_NEXT, "fsync"))(file);
}

int fdatasync(int file) {
    stall();
    return ((int (*)(int))dlsym(RTLD_NEXT, "fdatasync"))(file);
}
