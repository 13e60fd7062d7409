/* The motion of a model: signals over time, consistent states, integration between two times. The method, its step
 * sizes and its stops are those of the crate `appell-runtime`. */
#ifndef FMI_MOTION_H_
#define FMI_MOTION_H_

#include "fmi-equations.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

/* Steps that a single call may take, rejected ones included. */
#define MOST_STEPS 1000000
/* Newton steps to a configuration that satisfies the position constraints. */
#define MOST_NEWTON_STEPS 20
/* Parts of a step between which jumps are sought. */
#define PARTS 8
/* Residuals of position constraints that count as zero. */
#define ROUNDING (16 * DBL_EPSILON)

/* A place of the motion, and what the next step needs to know. Plain numbers, so that a copy is a snapshot. */
typedef struct {
    int32_t mode;
    int32_t co_simulation;
    double t;
    double x[STATES];
    double u[ROOM(INPUTS)];
    double before_u[ROOM(INPUTS)];   /* co-simulation: inputs at the start of the last step */
    double since_u;                  /* co-simulation: that start; infinite before the first step */
    double slopes[ROOM(INPUTS)];     /* co-simulation: slopes of the inputs that are not held, from the start on */
    double p[ROOM(PARAMETERS)];
    double tolerance;
    double step;                     /* proposed length of the next step; 0 where none is known */
    double floor;                    /* model exchange: the last row of a signal's table */
    double next_row;                 /* model exchange: the next row, up to which the rates are those before it */
    double since;                    /* model exchange: a time at which the switches had the values below */
    double switched[ROOM(SWITCHES)]; /* model exchange: the switches since the last event */
} Motion;

/* Why a motion cannot be continued. */
typedef enum { DONE, RATES_NOT_FINITE, STEP_TOO_SMALL, TOO_MANY_STEPS } Ending;

static double before(double t) {
    return nextafter(t, -HUGE_VAL);
}

static double larger(double a, double b) {
    return a > b ? a : b;
}

static double smaller(double a, double b) {
    return a < b ? a : b;
}

/* The derivative of a signal of order 0, 1 or 2; at a row the limit from the right. */
static double signal_at(int signal, int order, double t) {
    const int first = signal_first[signal], last = signal_first[signal + 1] - 1;
    int low = first, high = last + 1, i;
    double step, since, left, right, jerk, slope;
    if (t != t) {
        return t;
    }
    /* `low` becomes the first row that is later. */
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (signal_times[middle] <= t) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    if (low == first || low > last) {
        return order > 0 ? 0 : signal_values[low == first ? first : last];
    }
    i = low - 1;
    if (signal_kinds[signal] == SIGNAL_HELD) {
        return order > 0 ? 0 : signal_values[i];
    }
    step = signal_times[i + 1] - signal_times[i];
    since = t - signal_times[i];
    left = signal_curvatures[i];
    right = signal_curvatures[i + 1];
    jerk = (right - left) / step;
    slope = (signal_values[i + 1] - signal_values[i]) / step - step * (2.0 * left + right) / 6.0;
    switch (order) {
    case 0:
        return signal_values[i] + since * (slope + since * (left / 2.0 + since * jerk / 6.0));
    case 1:
        return slope + since * (left + since * jerk / 2.0);
    default:
        return left + since * jerk;
    }
}

/* The first row of a signal after a time, at most `end`. */
static double next_row(double t, double end) {
    double next = end;
    int row;
    for (row = 0; row < signal_first[SIGNALS]; row++) {
        if (signal_times[row] > t && signal_times[row] < next) {
            next = signal_times[row];
        }
    }
    return next;
}

/* All inputs of the equations: the declared ones are held or run on along lines, signals and their rates follow. */
static void fill_inputs(const Motion *m, double t, double *u) {
    int i;
    for (i = 0; i < INPUTS; i++) {
        u[i] = m->slopes[i] != 0 ? m->u[i] + m->slopes[i] * (t - m->since_u) : m->u[i];
    }
    for (i = INPUTS; i < ALL_INPUTS; i++) {
        u[i] = signal_at(signal_of_input[i - INPUTS], order_of_input[i - INPUTS], t);
    }
}

static void rates_at(const Motion *m, double t, const double *x, double *rates) {
    double u[ROOM(ALL_INPUTS)];
    fill_inputs(m, t, u);
    rates_of_model(t, m->p, x, u, rates);
}

/* What time alone switches; neither state nor inputs matter. */
static void switches_at(const Motion *m, double t, double *values) {
    double u[ROOM(ALL_INPUTS)];
    memset(u, 0, sizeof u);
    switches_of_model(t, m->p, m->x, u, values);
}

static int switches_differ(const Motion *m, double t, const double *from) {
    double values[ROOM(SWITCHES)];
    if (SWITCHES == 0) {
        return 0;
    }
    switches_at(m, t, values);
    return memcmp(values, from, (size_t)SWITCHES * sizeof(double)) != 0;
}

/* The first time after `t` and not after `end` at which the switches are not as at `t`, to the last digit. */
static int jump_within(const Motion *m, double t, double end, double *jump) {
    double from[ROOM(SWITCHES)], same = t, other = end;
    int part;
    if (SWITCHES == 0) {
        return 0;
    }
    switches_at(m, t, from);
    for (part = 1; part <= PARTS; part++) {
        other = part == PARTS ? end : t + (end - t) * (part / (double)PARTS);
        if (switches_differ(m, other, from)) {
            break;
        }
        same = other;
    }
    if (part > PARTS) {
        return 0;
    }
    for (;;) {
        const double middle = same + (other - same) / 2.0;
        if (middle <= same || middle >= other) {
            *jump = other;
            return 1;
        }
        if (switches_differ(m, middle, from)) {
            other = middle;
        } else {
            same = middle;
        }
    }
}

static double largest(const double *values, int count) {
    double most = 0;
    int i;
    for (i = 0; i < count; i++) {
        const double size = fabs(values[i]);
        if (size > most || size != size) {
            most = size;
        }
    }
    return most;
}

static int all_finite(const double *values, int count) {
    int i;
    for (i = 0; i < count; i++) {
        if (!isfinite(values[i])) {
            return 0;
        }
    }
    return 1;
}

/* Solves A x = right for several right sides, columns of an n by c matrix; false for a singular A. */
static int solved(double *a, double *right, int n, int c) {
    int i, j, k;
    for (k = 0; k < n; k++) {
        for (i = k + 1; i < n; i++) {
            if (fabs(a[k * n + k]) < fabs(a[i * n + k])) {
                for (j = 0; j < n; j++) {
                    const double upper = a[k * n + j];
                    a[k * n + j] = a[i * n + j];
                    a[i * n + j] = upper;
                }
                for (j = 0; j < c; j++) {
                    const double upper = right[k * c + j];
                    right[k * c + j] = right[i * c + j];
                    right[i * c + j] = upper;
                }
            }
        }
        if (!(fabs(a[k * n + k]) > 0)) {
            return 0;
        }
        for (i = k + 1; i < n; i++) {
            const double factor = a[i * n + k] / a[k * n + k];
            for (j = k + 1; j < n; j++) {
                a[i * n + j] -= factor * a[k * n + j];
            }
            for (j = 0; j < c; j++) {
                right[i * c + j] -= factor * right[k * c + j];
            }
        }
    }
    for (i = n - 1; i >= 0; i--) {
        for (j = 0; j < c; j++) {
            for (k = i + 1; k < n; k++) {
                right[i * c + j] -= a[i * n + k] * right[k * c + j];
            }
            right[i * c + j] /= a[i * n + i];
        }
    }
    return all_finite(right, n * c);
}

/* Moves coordinates until the position constraints hold: the dependent ones by themselves, or all as little as
 * possible. False where no such configuration is near. */
static int restore(const Motion *m, double t, double *x, int only_dependent) {
    enum { Q = STATES - SPEEDS };
    double u[ROOM(ALL_INPUTS)], residual[ROOM(DEPENDENT)], jacobian[ROOM(DEPENDENT * Q)];
    double matrix[ROOM(DEPENDENT * DEPENDENT)], last = HUGE_VAL;
    int step, i, j, k;
    if (DEPENDENT == 0) {
        return 1;
    }
    fill_inputs(m, t, u);
    for (step = 0; step < MOST_NEWTON_STEPS; step++) {
        double size, scale;
        position_constraints_of_model(t, m->p, x, u, residual, jacobian);
        size = largest(residual, DEPENDENT);
        scale = larger(largest(x + SPEEDS, Q), 1.0);
        if (size <= ROUNDING * scale || (size >= last && size <= 1e3 * ROUNDING * scale)) {
            return 1;
        }
        last = size;
        for (i = 0; i < DEPENDENT; i++) {
            for (j = 0; j < DEPENDENT; j++) {
                double sum = 0;
                if (only_dependent) {
                    sum = jacobian[i * Q + dependent_coordinates[j]];
                } else {
                    for (k = 0; k < Q; k++) {
                        sum += jacobian[i * Q + k] * jacobian[j * Q + k];
                    }
                }
                matrix[i * DEPENDENT + j] = sum;
            }
        }
        if (!isfinite(size) || !solved(matrix, residual, DEPENDENT, 1)) {
            return 0;
        }
        for (j = 0; j < DEPENDENT; j++) {
            if (only_dependent) {
                x[SPEEDS + dependent_coordinates[j]] -= residual[j];
            } else {
                for (k = 0; k < Q; k++) {
                    x[SPEEDS + k] -= jacobian[j * Q + k] * residual[j];
                }
            }
        }
    }
    return 0;
}

/* The sum of a row of the tableau over the rates of the stages. */
static double weighted(int row, double k[][STATES], int state) {
    double sum = 0;
    int term;
    for (term = row_first[row]; term < row_first[row + 1]; term++) {
        sum += row_weights[term] * k[row_stages[term]][state];
    }
    return sum;
}

static double norm(const double *values, const double *scale) {
    double sum = 0;
    int i;
    for (i = 0; i < STATES; i++) {
        sum += (values[i] / scale[i]) * (values[i] / scale[i]);
    }
    return sqrt(sum / STATES);
}

static void set_scale(double tolerance, const double *a, const double *b, double *scale) {
    int i;
    for (i = 0; i < STATES; i++) {
        scale[i] = larger(tolerance + tolerance * larger(fabs(a[i]), fabs(b[i])), DBL_MIN);
    }
}

/* A first step from the sizes of the state, its rates and their change. */
static double first_step(const Motion *m, double t, const double *rates, double longest, double last) {
    double scale[STATES], x[STATES], later[STATES], size, change, guess, step, most;
    int i;
    set_scale(m->tolerance, m->x, m->x, scale);
    size = norm(rates, scale);
    guess = norm(m->x, scale);
    guess = guess < 1e-5 || size < 1e-5 ? 1e-6 : 0.01 * guess / size;
    guess = smaller(guess, longest);
    for (i = 0; i < STATES; i++) {
        x[i] = m->x[i] + guess * rates[i];
    }
    rates_at(m, smaller(t + guess, last), x, later);
    for (i = 0; i < STATES; i++) {
        later[i] -= rates[i];
    }
    change = norm(later, scale) / guess;
    most = larger(size, change);
    if (!isfinite(change)) {
        step = 1e-3 * guess;
    } else if (most <= 1e-15) {
        step = larger(1e-6, 1e-3 * guess);
    } else {
        step = pow(0.01 / most, 1.0 / 8.0);
    }
    return smaller(smaller(step, 100.0 * guess), longest);
}

/* All stages of a step of length h and the new state; returns the error over the tolerance, NaN where there is no
 * such state. Rates are evaluated up to `last`. */
static double attempt(const Motion *m, double t, double h, double t_new, double last, double k[][STATES], double *x_new) {
    double scale[STATES], x[STATES], square_5 = 0, square_3 = 0, denominator;
    int stage, i;
    for (stage = 0; stage < STAGES; stage++) {
        double *to = stage == STAGES - 1 ? x_new : x;
        for (i = 0; i < STATES; i++) {
            to[i] = m->x[i] + h * weighted(stage, k, i);
        }
        if (stage < STAGES - 1) {
            rates_at(m, smaller(t + stage_nodes[stage] * h, last), x, k[stage + 1]);
        }
    }
    if (!restore(m, t_new, x_new, 0) || !all_finite(x_new, STATES)) {
        return NAN;
    }
    set_scale(m->tolerance, m->x, x_new, scale);
    for (i = 0; i < STATES; i++) {
        const double error_5 = weighted(ERROR_5, k, i) / scale[i], error_3 = weighted(ERROR_3, k, i) / scale[i];
        square_5 += error_5 * error_5;
        square_3 += error_3 * error_3;
    }
    square_5 /= STATES;
    square_3 /= STATES;
    denominator = square_5 + 0.01 * square_3;
    return denominator == 0 ? 0 : h * square_5 / sqrt(denominator);
}

/* Lets inputs run on in the step that begins: along the lines through their values at its start and at the last one's. */
static void draw_lines(Motion *m) {
    int i;
    for (i = 0; i < INPUTS && INPUTS_ARE_LINES; i++) {
        m->slopes[i] = m->t > m->since_u ? (m->u[i] - m->before_u[i]) / (m->t - m->since_u) : 0;
    }
    memcpy(m->before_u, m->u, sizeof m->u);
    m->since_u = m->t;
}

/* Moves from the present time to `end` by the pair of order 8(5,3) of Dormand and Prince (Hairer, Norsett and Wanner,
 * Solving Ordinary Differential Equations I, section II.10). Steps end at rows of signals and at jumps. */
static Ending move_to(Motion *m, double end) {
    double k[STAGES][STATES], x_new[STATES];
    int restart = 1, after_rejection = 0, steps;
    for (steps = 0; m->t < end; steps++) {
        const double t = m->t, row = next_row(t, end);
        const double last_known = row < end || end == next_row(before(end), HUGE_VAL) ? before(row) : row;
        double stop = row, last = last_known, h, t_new, jump, error;
        int lands;
        if (restart) {
            rates_at(m, t, m->x, k[0]);
            if (!all_finite(k[0], STATES)) {
                return RATES_NOT_FINITE;
            }
        }
        if (steps >= MOST_STEPS) {
            return TOO_MANY_STEPS;
        }
        if (!(m->step > 0)) {
            m->step = first_step(m, t, k[0], stop - t, last);
        }
        h = m->step;
        lands = t + 1.01 * h >= stop;
        t_new = lands ? stop : t + h;
        last = lands ? last : t_new;
        if (jump_within(m, t, t_new, &jump)) {
            lands = 1;
            t_new = jump;
            last = before(jump);
        }
        if (lands) {
            h = t_new - t;
        }
        error = attempt(m, t, h, t_new, last, k, x_new);
        if (error <= 1.0) {
            double factor = 0.9 / pow(error, 0.125), suggested;
            factor = larger(0.333, smaller(factor, after_rejection ? 1.0 : 6.0));
            suggested = h * factor;
            /* A step cut short says nothing against the longer one. */
            m->step = lands ? larger(suggested, m->step) : suggested;
            m->t = t_new;
            memcpy(m->x, x_new, sizeof x_new);
            restart = 1;
            after_rejection = 0;
        } else {
            const double factor = isfinite(error) ? larger(0.333, smaller(0.9 / pow(error, 0.125), 1.0)) : 0.25;
            m->step = h * factor;
            if (t + 0.1 * m->step <= t) {
                m->step = 0;
                return isfinite(error) ? STEP_TOO_SMALL : RATES_NOT_FINITE;
            }
            restart = 0;
            after_rejection = 1;
        }
    }
    return DONE;
}

#endif
