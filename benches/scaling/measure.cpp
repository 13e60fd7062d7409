// Times every function in turn, over states that no call can predict from the last.
//   measure MODELS STATES ROUNDS    prints: function, then one time in ns per round
//   measure MODELS STATES 0         prints: function, then the results at the first CHECKED states
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include "kernels.h"  // APPELL, CASADI, PINOCCHIO: X(robot, its number, function, size of the results)

enum { STATES = 256, CHECKED = 4 };
// A measurement of one function takes about this long.
static const double SLICE = 2e6;

void pinocchio_read(const char *path);
void pinocchio_rates(int robot, const double *x, double *out);
void pinocchio_jacobians(int robot, const double *x, double *out);

typedef void (*Call)(int robot, const double *x, double *out);

extern "C" {
#define X(robot, number, function, size) void appell_##robot##_##function(const double *x, double *out);
APPELL
#undef X
#define X(robot, number, function, size) void casadi_##robot##_##function(const double *x, double *out);
CASADI
#undef X
}

struct Entry {
    const char *tool, *robot, *function;
    int number, size;
    Call call;
    std::vector<double> states;
    size_t width;
};

static double out[1 << 14];

static double now() {
    timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * double(t.tv_sec) + double(t.tv_nsec);
}

int main(int argc, char **argv) {
    if (argc != 4) return 2;
    const int rounds = atoi(argv[3]);
    pinocchio_read(argv[1]);
    std::vector<Entry> entries = {
#define X(robot, number, function, size) \
    {"appell", #robot, #function, number, size, [](int, const double *x, double *to) { appell_##robot##_##function(x, to); }, {}, 0},
        APPELL
#undef X
#define X(robot, number, function, size) \
    {"casadi", #robot, #function, number, size, [](int, const double *x, double *to) { casadi_##robot##_##function(x, to); }, {}, 0},
        CASADI
#undef X
#define X(robot, number, function, size) {"pinocchio", #robot, #function, number, size, pinocchio_##function, {}, 0},
        PINOCCHIO
#undef X
    };
    // Tool, robot, width of a state, the states.
    std::ifstream in(argv[2]);
    std::string tool, robot;
    size_t width;
    while (in >> tool >> robot >> width) {
        std::vector<double> states(width * STATES);
        for (double &value : states) in >> value;
        for (Entry &entry : entries)
            if (tool == entry.tool && robot == entry.robot) entry.states = states, entry.width = width;
    }
    if (rounds == 0) {
        for (const Entry &entry : entries) {
            printf("%s.%s.%s", entry.tool, entry.robot, entry.function);
            for (int s = 0; s < CHECKED; s++) {
                entry.call(entry.number, &entry.states[s * entry.width], out);
                for (int j = 0; j < entry.size; j++) printf("\t%.17g", out[j]);
            }
            printf("\n");
        }
        return 0;
    }
    std::vector<std::vector<double>> times(entries.size());
    std::vector<int> repeat(entries.size(), 1);
    for (int round = -1; round < rounds; round++)
        for (size_t e = 0; e < entries.size(); e++) {
            const Entry &entry = entries[e];
            double *to = entry.call == pinocchio_rates || entry.call == pinocchio_jacobians ? nullptr : out;
            const double start = now();
            for (int r = 0; r < repeat[e]; r++)
                for (int s = 0; s < STATES; s++) {
                    entry.call(entry.number, &entry.states[s * entry.width], to);
                    __asm__ volatile("" : : "r"(out) : "memory");
                }
            const double spent = now() - start;
            if (round < 0) repeat[e] = spent < SLICE ? 1 + int(SLICE / spent) : 1;
            else times[e].push_back(spent / (repeat[e] * STATES));
        }
    for (size_t e = 0; e < entries.size(); e++) {
        printf("%s.%s.%s", entries[e].tool, entries[e].robot, entries[e].function);
        for (const double time : times[e]) printf("\t%.3f", time);
        printf("\n");
    }
}
