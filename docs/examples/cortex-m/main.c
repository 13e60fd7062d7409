/* The unicycle on a Cortex-M4 with single precision: a model that runs along with the mechanism, a thousand steps a
 * second, under the command that the actuator gets. */

#include <stdint.h>

#include "unicycle.h"

/* Clock of the core, and steps a second: those of the board and of the controller. */
#define CLOCK_HZ 100000000u
#define RATE_HZ 1000u

/* What the rest of the program writes and reads. */
volatile float command;
volatile UnicycleState predicted;

static volatile uint32_t ticks;

/* Registers of every Cortex-M4. */
#define SYSTICK_CONTROL (*(volatile uint32_t *)0xE000E010u)
#define SYSTICK_RELOAD (*(volatile uint32_t *)0xE000E014u)
#define COPROCESSORS (*(volatile uint32_t *)0xE000ED88u)

static void on_tick(void) {
    ticks++;
}

int main(void) {
    const UnicycleParameters p = unicycle_default_parameters;
    const float dt = 1.0f / (float)RATE_HZ;
    UnicycleState x = unicycle_initial_state;
    uint32_t done = 0;
    SYSTICK_RELOAD = CLOCK_HZ / RATE_HZ - 1u;
    SYSTICK_CONTROL = 7u;
    for (;;) {
        UnicycleInputs u;
        while (ticks == done) {
        }
        u.u = command;
        unicycle_step((float)done * dt, dt, &p, &x, &u);
        predicted = x;
        done++;
    }
}

/* Start-up: memory, the unit for floating-point numbers, the table of interrupts. */
extern uint32_t stack_top[], data_source[], data_start[], data_end[], bss_start[], bss_end[];

void reset(void) {
    const uint32_t *from = data_source;
    uint32_t *to;
    for (to = data_start; to < data_end; to++) {
        *to = *from++;
    }
    for (to = bss_start; to < bss_end; to++) {
        *to = 0;
    }
    COPROCESSORS |= 0xFu << 20;
    __asm volatile("dsb\nisb");
    (void)main();
}

static void halt(void) {
    for (;;) {
    }
}

typedef union {
    uint32_t *stack;
    void (*handler)(void);
} Vector;

const Vector vectors[16] __attribute__((section(".vectors"), used)) = {
    {.stack = stack_top},
    {.handler = reset},
    {.handler = halt}, /* non-maskable interrupt */
    {.handler = halt}, /* faults */
    {.handler = halt},
    {.handler = halt},
    {.handler = halt},
    [15] = {.handler = on_tick},
};
