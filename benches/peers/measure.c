// Times every kernel in turn, over states that no call can predict from the last.
//   measure ROUNDS < states    prints: kernel, then one time in ns per round
//   measure 0 < states         prints: kernel, then the results at the first CHECKED states
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include "kernels.h"  // KERNELS: X(tool, kernel, n, m, k, size, mechanism)

enum { STATES = 256, REPEAT = 8, CHECKED = 8 };
typedef void (*Kernel)(const double *, const double *, const double *, double *);

#define X(tool, kernel, n, m, k, size, mechanism) \
    void tool##_##kernel(const double *, const double *, const double *, double *);
KERNELS
#undef X

struct Entry { const char *name; Kernel call; int n, m, k, size, mechanism; };
static const struct Entry entries[] = {
#define X(tool, kernel, n, m, k, size, mechanism) \
    {#tool "." #kernel, tool##_##kernel, n, m, k, size, mechanism},
    KERNELS
#undef X
};
enum { COUNT = sizeof entries / sizeof *entries };

static double states[MECHANISMS][STATES][16], inputs[MECHANISMS][STATES][4], parameters[MECHANISMS][32];
static double out[512];

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static double read_number(void) {
    double value;
    if (scanf("%lf", &value) != 1) exit(1);
    return value;
}

int main(int argc, char **argv) {
    int rounds = argc > 1 ? atoi(argv[1]) : 0;
    for (int i = 0; i < MECHANISMS; i++) {
        int n = (int)read_number(), m = (int)read_number(), k = (int)read_number();
        for (int j = 0; j < k; j++) parameters[i][j] = read_number();
        for (int s = 0; s < STATES; s++) {
            for (int j = 0; j < n; j++) states[i][s][j] = read_number();
            for (int j = 0; j < m; j++) inputs[i][s][j] = read_number();
        }
    }
    if (rounds == 0) {
        for (int e = 0; e < COUNT; e++) {
            int i = entries[e].mechanism;
            printf("%s", entries[e].name);
            for (int s = 0; s < CHECKED; s++) {
                entries[e].call(states[i][s], inputs[i][s], parameters[i], out);
                for (int j = 0; j < entries[e].size; j++) printf("\t%.17g", out[j]);
            }
            printf("\n");
        }
        return 0;
    }
    double *times = malloc(sizeof *times * (size_t)(rounds * COUNT));
    if (!times) return 1;
    for (int round = -1; round < rounds; round++)
        for (int e = 0; e < COUNT; e++) {
            const struct Entry *entry = &entries[e];
            int i = entry->mechanism;
            double start = now();
            for (int r = 0; r < REPEAT; r++)
                for (int s = 0; s < STATES; s++) {
                    entry->call(states[i][s], inputs[i][s], parameters[i], out);
                    __asm__ volatile("" : : "r"(out) : "memory");
                }
            if (round >= 0) times[e * rounds + round] = (now() - start) / (REPEAT * STATES);
        }
    for (int e = 0; e < COUNT; e++) {
        printf("%s", entries[e].name);
        for (int round = 0; round < rounds; round++) printf("\t%.3f", times[e * rounds + round]);
        printf("\n");
    }
    free(times);
    return 0;
}
