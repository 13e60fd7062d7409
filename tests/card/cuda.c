/* A processor in the place of a graphics card: the calls of the CUDA driver that kernels need. Memory is that of the
 * process; a module is the path of a shared library, as `nvrtc.c` writes it, and a kernel NAME is called as NAME_with. */

#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef int Result;
enum { SUCCESS = 0, OUT_OF_MEMORY = 2, INVALID_IMAGE = 200, NOT_FOUND = 500 };

/* With CARD_MEMORY, an array of more bytes does not fit. */
static int fits(size_t bytes) {
    const char *most = getenv("CARD_MEMORY");
    return !most || bytes <= (size_t)atoll(most);
}

Result cuInit(unsigned flags) {
    (void)flags;
    return SUCCESS;
}

Result cuDeviceGet(int *device, int ordinal) {
    *device = ordinal;
    return SUCCESS;
}

Result cuDeviceGetName(char *name, int length, int device) {
    (void)device;
    snprintf(name, (size_t)length, "a processor in the place of a card");
    return SUCCESS;
}

Result cuDeviceGetAttribute(int *value, int attribute, int device) {
    (void)device;
    /* Compute capability 8.0; no memory pools. */
    *value = attribute == 75 ? 8 : 0;
    return SUCCESS;
}

Result cuDevicePrimaryCtxRetain(void **context, int device) {
    (void)device;
    *context = (void *)1;
    return SUCCESS;
}

Result cuDevicePrimaryCtxRelease_v2(int device) {
    (void)device;
    return SUCCESS;
}

Result cuCtxSetCurrent(void *context) {
    (void)context;
    return SUCCESS;
}

Result cuCtxGetCurrent(void **context) {
    *context = (void *)1;
    return SUCCESS;
}

Result cuMemAlloc_v2(uint64_t *address, size_t bytes) {
    *address = (uint64_t)(uintptr_t)(fits(bytes) ? malloc(bytes) : 0);
    return *address ? SUCCESS : OUT_OF_MEMORY;
}

Result cuMemFree_v2(uint64_t address) {
    free((void *)(uintptr_t)address);
    return SUCCESS;
}

Result cuMemsetD8Async(uint64_t address, unsigned char value, size_t bytes, void *stream) {
    (void)stream;
    memset((void *)(uintptr_t)address, value, bytes);
    return SUCCESS;
}

Result cuMemcpyHtoDAsync_v2(uint64_t to, const void *from, size_t bytes, void *stream) {
    (void)stream;
    memcpy((void *)(uintptr_t)to, from, bytes);
    return SUCCESS;
}

Result cuMemcpyDtoHAsync_v2(void *to, uint64_t from, size_t bytes, void *stream) {
    (void)stream;
    memcpy(to, (void *)(uintptr_t)from, bytes);
    return SUCCESS;
}

Result cuEventCreate(void **event, unsigned flags) {
    (void)flags;
    *event = (void *)1;
    return SUCCESS;
}

Result cuEventRecord(void *event, void *stream) {
    (void)event, (void)stream;
    return SUCCESS;
}

Result cuEventSynchronize(void *event) {
    (void)event;
    return SUCCESS;
}

Result cuEventDestroy_v2(void *event) {
    (void)event;
    return SUCCESS;
}

Result cuStreamWaitEvent(void *stream, void *event, unsigned flags) {
    (void)stream, (void)event, (void)flags;
    return SUCCESS;
}

Result cuStreamSynchronize(void *stream) {
    (void)stream;
    return SUCCESS;
}

Result cuGetErrorString(Result error, const char **text) {
    *text = error == OUT_OF_MEMORY ? "out of memory" : "an error of the card";
    return SUCCESS;
}

Result cuGetErrorName(Result error, const char **text) {
    return cuGetErrorString(error, text);
}

Result cuModuleLoadData(void **module, const void *image) {
    *module = dlopen(image, RTLD_NOW | RTLD_LOCAL);
    return *module ? SUCCESS : INVALID_IMAGE;
}

Result cuModuleUnload(void *module) {
    return dlclose(module) ? INVALID_IMAGE : SUCCESS;
}

Result cuModuleGetFunction(void **function, void *module, const char *name) {
    char with[256];
    snprintf(with, sizeof with, "%s_with", name);
    *function = dlsym(module, with);
    return *function ? SUCCESS : NOT_FOUND;
}

Result cuLaunchKernel(void *function, unsigned x, unsigned y, unsigned z, unsigned block_x, unsigned block_y,
                      unsigned block_z, unsigned shared, void *stream, void **arguments, void **extra) {
    (void)x, (void)y, (void)z, (void)block_x, (void)block_y, (void)block_z, (void)shared, (void)stream, (void)extra;
    ((void (*)(void **))function)(arguments);
    return SUCCESS;
}
