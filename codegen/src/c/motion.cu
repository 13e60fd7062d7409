/* An embedded Runge-Kutta pair with step-size control and dense output (E. Hairer, S. P. Norsett and G. Wanner,
 * Solving Ordinary Differential Equations I, sections II.4 to II.6 and II.10), switching functions, ranges, events and
 * kept quantities: the operations of the processor, without its interval bounds. */

/* Why a motion ended. */
enum { FINISHED, NOT_FINITE, OUT_OF_RANGE, STEP_TOO_SMALL, TOO_MANY_STEPS, CHATTERING };
/* How a quantity is followed. */
enum { LARGEST, SMALLEST, MEAN };
/* Functions along the motion. */
enum { OF_EVENTS, OF_FOLLOWED };

#define IS_FINITE(a) ((a) - (a) == 0)
/* Bits of a number of binary floating point. */
#define EPSILON 2.220446049250313e-16
/* A negligible step, relative to the time, and so many of them after a switch count as chattering. */
#define SLIVER 1e-9
#define MOST_SLIVERS 300
/* Nodes of a piece, bisections of a piece, most pieces of an interval, points of the polynomial between two nodes. */
#define NODES 9
#define HALVINGS 24
#define MOST_PIECES 1024
#define PARTS 4
#define FINE (PARTS * (NODES - 1) + 1)
/* Bound on the last coefficients of a resolved function, and error of means and extrema for each step. */
#define TAIL 1e-7

/* A motion, its current step from t to t_new with dense output, and the stretch of it from t to `to` that is shown. */
typedef struct {
    const double *p;
    const double *noise;
    double t, h, t_new, last, to;
    double x[STATES], x_new[STATES], x_to[STATES];
    double k[STAGES][STATES];
    double dense[COEFFICIENTS][STATES];
    int signs[EVENTS + 1];
    double sizes[EVENTS + 1], hits[EVENTS + 1];
    double best[FOLLOWED + 1], when[FOLLOWED + 1], first[FOLLOWED + 1], largest[FOLLOWED + 1];
    int is_undefined[FOLLOWED + 1];
} Motion;

/* A function on an interval: values at the extrema of the Chebyshev polynomial of degree 8, and coefficients. */
typedef struct {
    double from, to;
    double values[NODES], c[NODES];
} Piece;

motion_FUNCTION double before(double t) {
    return nextafter(t, -INFINITY);
}

motion_FUNCTION double at_most(double a, double b) {
    return b < a ? b : a;
}

motion_FUNCTION double at_least(double a, double b) {
    return b > a ? b : a;
}

motion_FUNCTION double within(double a, double low, double high) {
    return at_most(at_least(a, low), high);
}

/* The longest negligible step that ends at a time. */
motion_FUNCTION double sliver(double t) {
    return SLIVER * at_least(fabs(t), 1);
}

/* The inputs: noises, each held for an interval. */
motion_CALLED void inputs_at(const Motion *m, double t, double *u) {
    int i;
    for (i = 0; i < INPUTS; i++) {
        u[i] = 0;
    }
    for (i = 0; i < NOISES; i++) {
        double every = noise_every[i];
        long long place = (long long)at_least(t / every, 0);
        while (place > 0 && (double)place * every > t) {
            place--;
        }
        while ((double)(place + 1) * every <= t) {
            place++;
        }
        u[FIRST_NOISE + i] = m->noise[noise_first[i] + place];
    }
}

motion_CALLED void derivative(const Motion *m, double t, const double *x, double *rates) {
    double u[INPUTS + 1];
    inputs_at(m, t, u);
    motion_rates(t, x, u, m->p, rates);
}

motion_FUNCTION double scale(double size) {
    return at_least(ABSOLUTE + RELATIVE * size, 2.2250738585072014e-308);
}

/* Root mean square of a vector over the tolerances at x. */
motion_FUNCTION double norm(const double *a, const double *x) {
    double sum = 0;
    int i;
    for (i = 0; i < STATES; i++) {
        double part = a[i] / scale(fabs(x[i]));
        sum += part * part;
    }
    return sqrt(sum / STATES);
}

/* The first step from the norms of the state and of its first and second derivatives (section II.4). */
motion_CALLED double first_step(Motion *m, double longest, double last) {
    double x_norm = norm(m->x, m->x), rates_norm = norm(m->k[0], m->x);
    double guess = x_norm < 1e-5 || rates_norm < 1e-5 ? 1e-6 : 0.01 * x_norm / rates_norm;
    double change[STATES], second, largest, step;
    int i;
    guess = at_most(guess, longest);
    for (i = 0; i < STATES; i++) {
        m->x_new[i] = fma(guess, m->k[0][i], m->x[i]);
    }
    derivative(m, at_most(m->t + guess, last), m->x_new, m->k[1]);
    for (i = 0; i < STATES; i++) {
        change[i] = m->k[1][i] - m->k[0][i];
    }
    second = norm(change, m->x) / guess;
    largest = at_least(rates_norm, second);
    if (!IS_FINITE(second)) {
        step = 1e-3 * guess;
    } else if (largest <= 1e-15) {
        step = at_least(1e-6, 1e-3 * guess);
    } else {
        step = pow(0.01 / largest, 1 / ORDER);
    }
    return at_most(at_most(step, 100 * guess), longest);
}

/* The state at a time within the step, by dense output, and component i with its rate. */
motion_CALLED void interpolated(const Motion *m, double t, double *x) {
    double theta = (t - m->t) / m->h;
    int c, i;
    for (i = 0; i < STATES; i++) {
        double value = m->dense[COEFFICIENTS - 1][i];
        for (c = COEFFICIENTS - 2; c >= 0; c--) {
            value = m->dense[c][i] + (c % 2 ? 1 - theta : theta) * value;
        }
        x[i] = value;
    }
}

motion_CALLED double component(const Motion *m, double t, int i, double *rate) {
    double theta = (t - m->t) / m->h, value = m->dense[COEFFICIENTS - 1][i], slope = 0;
    int c;
    for (c = COEFFICIENTS - 2; c >= 0; c--) {
        double factor = c % 2 ? 1 - theta : theta;
        slope = (c % 2 ? -1 : 1) / m->h * value + factor * slope;
        value = m->dense[c][i] + factor * value;
    }
    *rate = slope;
    return value;
}

/* The state within the stretch, up to just before its end. */
motion_FUNCTION void state_at(const Motion *m, double t, double *x) {
    int i;
    if (t > m->t && t < before(m->to)) {
        interpolated(m, t, x);
        return;
    }
    for (i = 0; i < STATES; i++) {
        x[i] = t <= m->t ? m->x[i] : m->x_to[i];
    }
}

motion_CALLED void dense_output(Motion *m) {
    int i;
    for (i = 0; i < STATES; i++) {
        double difference = m->x_new[i] - m->x[i], bend = m->h * m->k[0][i] - difference;
        m->dense[0][i] = m->x[i];
        m->dense[1][i] = difference;
        m->dense[2][i] = bend;
        m->dense[3][i] = difference - m->h * m->k[NEW_RATES][i] - bend;
    }
    interior(m);
}

/* a x = b for so many rows by elimination with partial pivoting; x replaces b. False if the matrix is singular. */
motion_FUNCTION int solved(double *a, double *b, int n) {
    int i, j, k;
    for (k = 0; k < n; k++) {
        int best = k;
        for (i = k + 1; i < n; i++) {
            best = fabs(a[i * n + k]) > fabs(a[best * n + k]) ? i : best;
        }
        for (j = 0; j < n && best != k; j++) {
            double upper = a[k * n + j];
            a[k * n + j] = a[best * n + j];
            a[best * n + j] = upper;
        }
        if (best != k) {
            double upper = b[k];
            b[k] = b[best];
            b[best] = upper;
        }
        if (!(fabs(a[k * n + k]) > 0)) {
            return 0;
        }
        for (i = k + 1; i < n; i++) {
            double factor = a[i * n + k] / a[k * n + k];
            for (j = k; j < n; j++) {
                a[i * n + j] -= factor * a[k * n + j];
            }
            b[i] -= factor * b[k];
        }
    }
    for (i = n - 1; i >= 0; i--) {
        for (j = i + 1; j < n; j++) {
            b[i] -= a[i * n + j] * b[j];
        }
        b[i] /= a[i * n + i];
    }
    return 1;
}

/* Projects coordinates orthogonally onto the position constraints by Newton's method (E. Hairer, C. Lubich and G. Wanner,
 * Geometric Numerical Integration, section IV.4). False if they cannot be satisfied near there. */
motion_CALLED int projected(const Motion *m, double t, double *x) {
    double u[INPUTS + 1], values[CONSTRAINTS * (1 + COORDINATES) + 1], matrix[CONSTRAINTS * CONSTRAINTS + 1];
    const double *jacobian = values + CONSTRAINTS;
    double *q = x + STATES - COORDINATES, last_size = INFINITY;
    int attempts, i, j, k;
    inputs_at(m, t, u);
    for (attempts = 0; attempts < 20; attempts++) {
        double size = 0, largest = 1;
        motion_constraints(t, x, u, m->p, values);
        for (i = 0; i < CONSTRAINTS; i++) {
            size = values[i] != values[i] ? NAN : at_least(size, fabs(values[i]));
        }
        for (i = 0; i < COORDINATES; i++) {
            largest = at_least(largest, fabs(q[i]));
        }
        if (size <= 16 * EPSILON * largest || (size >= last_size && size <= 16e3 * EPSILON * largest)) {
            return 1;
        }
        last_size = size;
        for (i = 0; i < CONSTRAINTS; i++) {
            for (j = 0; j < CONSTRAINTS; j++) {
                double product = 0;
                for (k = 0; k < COORDINATES; k++) {
                    product += jacobian[i * COORDINATES + k] * jacobian[j * COORDINATES + k];
                }
                matrix[i * CONSTRAINTS + j] = product;
            }
        }
        if (!IS_FINITE(size) || !solved(matrix, values, CONSTRAINTS)) {
            return 0;
        }
        for (j = 0; j < CONSTRAINTS; j++) {
            for (k = 0; k < COORDINATES; k++) {
                q[k] -= jacobian[j * COORDINATES + k] * values[j];
            }
        }
    }
    return 0;
}

/* All functions of a kind at a time within the stretch. */
motion_CALLED void evaluated(const Motion *m, int kind, double t, double *values) {
    double x[STATES], u[INPUTS + 1];
    state_at(m, t, x);
    inputs_at(m, t, u);
    if (kind == OF_EVENTS) {
        motion_events(t, x, u, m->p, values);
    } else {
        motion_followed(t, x, u, m->p, values);
    }
}

motion_FUNCTION double value_of(const Motion *m, int kind, int which, double t) {
    double values[MOST_FUNCTIONS];
    evaluated(m, kind, t, values);
    return values[which];
}

motion_CALLED double crossing(const Motion *m, int which, double t) {
    double x[STATES], u[INPUTS + 1], values[CROSSINGS + 1];
    interpolated(m, t, x);
    inputs_at(m, t, u);
    motion_crossings(t, x, u, m->p, values);
    return values[which];
}

/* cos(j pi / 8) */
motion_FUNCTION double cosine(int j) {
    const double all[NODES] = {1, 0.9238795325112867, 0.7071067811865475, 0.3826834323650898, 0, -0.3826834323650898,
                               -0.7071067811865475, -0.9238795325112867, -1};
    return all[j];
}

motion_FUNCTION double node(double from, double to, int j) {
    if (j == 0 || j == NODES - 1) {
        return j ? to : from;
    }
    return within(0.5 * (from + to) - 0.5 * (to - from) * cosine(j), from, to);
}

/* The Chebyshev coefficients of the values. */
motion_CALLED void resolve(Piece *piece) {
    int j, k;
    for (k = 0; k < NODES; k++) {
        double sum = 0;
        for (j = 0; j < NODES; j++) {
            int turns = k * (NODES - 1 - j) % (2 * (NODES - 1));
            double weight = j == 0 || j == NODES - 1 ? 0.5 : 1;
            sum += weight * cosine(turns < NODES ? turns : 2 * (NODES - 1) - turns) * piece->values[j];
        }
        piece->c[k] = sum * (k == 0 || k == NODES - 1 ? 1.0 : 2.0) / (NODES - 1);
    }
}

motion_FUNCTION double smallest(const Piece *piece) {
    double least = INFINITY;
    int j;
    for (j = 0; j < NODES; j++) {
        least = at_most(least, piece->values[j]);
    }
    return least;
}

motion_FUNCTION double greatest(const Piece *piece) {
    double most = -INFINITY;
    int j;
    for (j = 0; j < NODES; j++) {
        most = at_least(most, piece->values[j]);
    }
    return most;
}

motion_FUNCTION int is_finite(const Piece *piece) {
    int j;
    for (j = 0; j < NODES; j++) {
        if (!IS_FINITE(piece->values[j])) {
            return 0;
        }
    }
    return 1;
}

motion_FUNCTION int is_resolved(const Piece *piece, double size) {
    return fabs(piece->c[NODES - 2]) + fabs(piece->c[NODES - 1]) <= TAIL * size &&
           fabs(piece->c[NODES - 3]) <= 100 * TAIL * size;
}

/* The polynomial at a point of [-1, 1] (C. W. Clenshaw). */
motion_FUNCTION double polynomial(const Piece *piece, double place) {
    double next = 0, after = 0;
    int k;
    for (k = NODES - 1; k > 0; k--) {
        double own = piece->c[k] + 2 * place * next - after;
        after = next;
        next = own;
    }
    return piece->c[0] + place * next - after;
}

motion_FUNCTION double time_of(const Piece *piece, double place) {
    double from = piece->from, to = piece->to;
    return within(0.5 * (from + to) + 0.5 * (to - from) * place, from, to);
}

/* Point i of the nodes and of those between them. */
motion_FUNCTION double fine_place(int i) {
    double place = -cosine(i / PARTS);
    return i % PARTS ? place + (-cosine(i / PARTS + 1) - place) * ((double)(i % PARTS) / PARTS) : place;
}

motion_FUNCTION double fine_value(const Piece *piece, int i) {
    return i % PARTS ? polynomial(piece, fine_place(i)) : piece->values[i / PARTS];
}

/* The maximum of the polynomial, times a sign, near three of its points, by parabolas; its place. */
motion_CALLED double turn(const Piece *piece, double sign, const double *places, const double *values) {
    double a = places[0], b = places[1], c = places[2], at_a = values[0], at_b = values[1], at_c = values[2];
    int i;
    for (i = 0; i < 3; i++) {
        double left = (b - a) * (at_b - at_c), right = (b - c) * (at_b - at_a);
        double place = b - 0.5 * ((b - a) * left - (b - c) * right) / (left - right), found;
        if (!(a < place && place < c)) {
            break;
        }
        found = sign * polynomial(piece, place);
        if (found >= at_b) {
            if (place < b) {
                c = b;
                at_c = at_b;
            } else {
                a = b;
                at_a = at_b;
            }
            b = place;
            at_b = found;
        } else if (place < b) {
            a = place;
            at_a = found;
        } else {
            c = place;
            at_c = found;
        }
    }
    return b;
}

/* The time of the maximum of the polynomial, times a sign, if it exceeds `above` between the nodes; else the start. */
motion_CALLED double top(const Piece *piece, double sign, double above) {
    double radius = 0, best = -INFINITY, places[3], values[3], place;
    int k, at = 1;
    for (k = 1; k < NODES; k++) {
        radius += fabs(piece->c[k]);
    }
    if (sign * piece->c[0] + radius <= above) {
        return piece->from;
    }
    for (k = 1; k < FINE - 1; k++) {
        double value = sign * fine_value(piece, k);
        if (value >= best) {
            best = value;
            at = k;
        }
    }
    for (k = 0; k < 3; k++) {
        places[k] = fine_place(at - 1 + k);
        values[k] = sign * fine_value(piece, at - 1 + k);
    }
    place = turn(piece, sign, places, values);
    return sign * polynomial(piece, place) > above ? time_of(piece, place) : piece->from;
}

motion_FUNCTION int sign_of_number(double a) {
    return a > 0 ? 1 : (a < 0 ? -1 : 0);
}

/* A zero of an event between two times (R. P. Brent, Algorithms for Minimization without Derivatives, chapter 4). With
 * `which` below zero, the time at which component -1 - which of the state has a value, or at which its rate is zero. */
motion_FUNCTION double sought(const Motion *m, int which, int of_rate, double value, double t) {
    double rate, own;
    if (which >= 0) {
        return value_of(m, OF_EVENTS, which, t);
    }
    own = component(m, t, -1 - which, &rate);
    return of_rate ? rate : own - value;
}

motion_CALLED double zero(const Motion *m, int which, int of_rate, double value, double a, double b) {
    double at_a = sought(m, which, of_rate, value, a), at_b = sought(m, which, of_rate, value, b);
    double c = a, at_c = at_a, step = b - a, step_before = step, length = fabs(b - a);
    int i;
    for (i = 0; i < 100; i++) {
        double tolerance, half;
        if (fabs(at_c) < fabs(at_b)) {
            a = b;
            b = c;
            c = a;
            at_a = at_b;
            at_b = at_c;
            at_c = at_a;
        }
        tolerance = 2 * EPSILON * fabs(b) + 0.5 * EPSILON * length;
        half = 0.5 * (c - b);
        if (fabs(half) <= tolerance || at_b == 0) {
            break;
        }
        if (fabs(step_before) < tolerance || fabs(at_a) <= fabs(at_b)) {
            step = step_before = half;
        } else {
            double s = at_b / at_a, p, q;
            if (a == c) {
                p = 2 * half * s;
                q = 1 - s;
            } else {
                double r = at_b / at_c;
                q = at_a / at_c;
                p = s * (2 * half * q * (q - r) - (b - a) * (r - 1));
                q = (q - 1) * (r - 1) * (s - 1);
            }
            if (p > 0) {
                q = -q;
            } else {
                p = -p;
            }
            if (2 * p < at_most(3 * half * q - fabs(tolerance * q), fabs(step_before * q))) {
                step_before = step;
                step = p / q;
            } else {
                step = step_before = half;
            }
        }
        a = b;
        at_a = at_b;
        b += fabs(step) > tolerance ? step : (half > 0 ? tolerance : -tolerance);
        at_b = sought(m, which, of_rate, value, b);
        if ((at_b > 0) == (at_c > 0)) {
            c = a;
            at_c = at_a;
            step = step_before = b - a;
        }
    }
    return b;
}

/* Compares an event with its last sign; a rise through zero is a hit. */
motion_FUNCTION void point(Motion *m, int which, double last, double t, double value) {
    int old = m->signs[which];
    if (value != value) {
        return;
    }
    m->signs[which] = sign_of_number(value);
    if (old < 0 && m->signs[which] >= 0 && !IS_FINITE(m->hits[which])) {
        m->hits[which] = last < t ? zero(m, which, 0, 0, last, t) : t;
    }
}

/* Whether a function is resolved on a piece, or known to be of no interest there. */
motion_FUNCTION int is_enough(const Motion *m, int kind, int which, const Piece *piece) {
    double least = smallest(piece), most = greatest(piece), spread = most - least;
    double size = at_least(fabs(least), fabs(most));
    if (!is_finite(piece)) {
        return 1;
    }
    if (kind == OF_EVENTS) {
        return at_least(least, -most) > 2 * spread || is_resolved(piece, at_least(size, 1e-6 * m->sizes[which]));
    }
    size = at_least(m->largest[which], size);
    if (is_resolved(piece, size)) {
        return 1;
    }
    switch (followed_kind[which]) {
    case LARGEST:
        return most + 2 * spread < m->best[which];
    case SMALLEST:
        return 2 * spread - least < m->best[which];
    default:
        return spread * (piece->to - piece->from) <= TAIL * size * (m->to - m->t);
    }
}

/* The hits of an event on a piece, between the nodes as well. */
motion_CALLED void see_event(Motion *m, int which, const Piece *piece) {
    double last = piece->from, radius = 0, doubts[FINE + NODES * PARTS];
    int j, k, count = 0, next = 0;
    m->sizes[which] = at_least(m->sizes[which], at_least(fabs(smallest(piece)), fabs(greatest(piece))));
    for (k = 1; k < NODES; k++) {
        radius += fabs(piece->c[k]);
    }
    if (IS_FINITE(radius) && radius >= fabs(piece->c[0])) {
        double values[FINE];
        for (k = 0; k < FINE; k++) {
            values[k] = fine_value(piece, k);
        }
        for (j = 0; j + 1 < NODES; j++) {
            int changes = 0;
            for (k = PARTS * j; k < PARTS * (j + 1); k++) {
                changes += sign_of_number(values[k]) != sign_of_number(values[k + 1]);
            }
            for (k = PARTS * j + 1; changes > 1 && k < PARTS * (j + 1); k++) {
                doubts[count++] = time_of(piece, fine_place(k));
            }
        }
        for (k = 1; k + 1 < FINE; k++) {
            double a = values[k - 1], b = values[k], c = values[k + 1];
            if (a * b > 0 && b * c > 0 && fabs(b) <= fabs(a) && fabs(b) <= fabs(c)) {
                double sign = b > 0 ? -1 : 1, places[3], near[3], place;
                for (j = 0; j < 3; j++) {
                    places[j] = fine_place(k - 1 + j);
                    near[j] = sign * values[k - 1 + j];
                }
                place = turn(piece, sign, places, near);
                if (sign * polynomial(piece, place) >= 0) {
                    doubts[count++] = time_of(piece, place);
                }
            }
        }
        /* In the order of time. */
        for (j = 1; j < count; j++) {
            double own = doubts[j];
            for (k = j; k > 0 && doubts[k - 1] > own; k--) {
                doubts[k] = doubts[k - 1];
            }
            doubts[k] = own;
        }
    }
    for (j = 0; j < NODES; j++) {
        double t = node(piece->from, piece->to, j);
        for (; next < count && doubts[next] <= t; next++) {
            point(m, which, last, doubts[next], value_of(m, OF_EVENTS, which, doubts[next]));
            last = doubts[next];
        }
        point(m, which, last, t, piece->values[j]);
        last = t;
    }
}

motion_FUNCTION void larger(Motion *m, int which, double t, double value) {
    if (value > m->best[which]) {
        m->best[which] = value;
        m->when[which] = t;
    }
}

/* The integral or the extremum of a followed quantity on a piece. */
motion_CALLED void see_followed(Motion *m, int which, const Piece *piece) {
    double sign = followed_kind[which] == SMALLEST ? -1 : 1, t;
    int j;
    m->largest[which] = at_least(m->largest[which], at_least(fabs(smallest(piece)), fabs(greatest(piece))));
    m->is_undefined[which] |= !is_finite(piece);
    if (followed_kind[which] == MEAN) {
        double mean = 0;
        for (j = 0; j < NODES; j += 2) {
            mean += piece->c[j] / (1 - j * j);
        }
        m->best[which] += (piece->to - piece->from) * mean;
        return;
    }
    for (j = 0; j < NODES; j++) {
        larger(m, which, node(piece->from, piece->to, j), sign * piece->values[j]);
    }
    t = top(piece, sign, m->best[which]);
    if (t > piece->from) {
        larger(m, which, t, sign * value_of(m, OF_FOLLOWED, which, t));
    }
}

/* Visits all functions of a kind on the stretch, up to just before its end, in pieces on which they are resolved. */
motion_CALLED void walk(Motion *m, int kind, int count) {
    double from = m->t, to = at_least(before(m->to), from);
    double starts[HALVINGS + 2], ends[HALVINGS + 2], values[NODES][MOST_FUNCTIONS];
    double intervals = within(ceil((to - from) / LONGEST), 1, 100000), interval;
    int halvings[HALVINGS + 2], depth, left, j, which;
    if (to <= from) {
        return;
    }
    for (interval = 0; interval < intervals; interval++) {
        starts[0] = from + (to - from) * (interval / intervals);
        ends[0] = interval + 1 < intervals ? from + (to - from) * ((interval + 1) / intervals) : to;
        halvings[0] = 0;
        depth = 1;
        left = MOST_PIECES;
        while (depth > 0) {
            Piece piece;
            double middle;
            int is_whole;
            depth--;
            piece.from = starts[depth];
            piece.to = ends[depth];
            middle = 0.5 * (piece.from + piece.to);
            for (j = 0; j < NODES; j++) {
                evaluated(m, kind, node(piece.from, piece.to, j), values[j]);
            }
            is_whole = halvings[depth] >= HALVINGS || left == 0 || !(piece.from < middle && middle < piece.to);
            for (which = 0; which < count && !is_whole; which++) {
                for (j = 0; j < NODES; j++) {
                    piece.values[j] = values[j][which];
                }
                resolve(&piece);
                if (!is_enough(m, kind, which, &piece)) {
                    break;
                }
            }
            if (is_whole || which == count) {
                for (which = 0; which < count; which++) {
                    for (j = 0; j < NODES; j++) {
                        piece.values[j] = values[j][which];
                    }
                    resolve(&piece);
                    if (kind == OF_EVENTS) {
                        see_event(m, which, &piece);
                    } else {
                        see_followed(m, which, &piece);
                    }
                }
                continue;
            }
            left--;
            halvings[depth]++;
            halvings[depth + 1] = halvings[depth];
            starts[depth + 1] = piece.from;
            ends[depth + 1] = middle;
            starts[depth] = middle;
            depth += 2;
        }
    }
}

/* The last time with the old sign and the first with the new one: the latter. */
motion_FUNCTION double first_with(const Motion *m, int which, double sign, double same, double other) {
    for (;;) {
        double middle = same + (other - same) / 2;
        if (middle <= same || middle >= other) {
            return other;
        }
        if (crossing(m, which, middle) * sign < 0) {
            other = middle;
        } else {
            same = middle;
        }
    }
}

/* A time between two at which a function that comes near zero has changed its sign; else infinity. */
motion_FUNCTION double changed_near_zero(const Motion *m, int which, double sign, double left, double right) {
    const double golden = 0.3819660112501051;
    double a = left + golden * (right - left), b = right - golden * (right - left);
    double at_a = crossing(m, which, a), at_b = crossing(m, which, b);
    int i;
    for (i = 0; i < 44; i++) {
        if (at_a * sign < 0 || at_b * sign < 0) {
            return at_a * sign < 0 ? a : b;
        }
        if (fabs(at_a) < fabs(at_b)) {
            right = b;
            b = a;
            at_b = at_a;
            a = left + golden * (right - left);
            at_a = crossing(m, which, a);
        } else {
            left = a;
            a = b;
            at_a = at_b;
            b = right - golden * (right - left);
            at_b = crossing(m, which, b);
        }
        if (b <= a) {
            break;
        }
    }
    return INFINITY;
}

/* The first time up to `to` at which a switching function has another sign; else infinity. */
motion_FUNCTION double first_change(const Motion *m, int which, double sign, double to) {
    double samples[9], from = m->t, near = 1e-3 * (to - from) / 8;
    int part, last = 8;
    samples[0] = crossing(m, which, from);
    for (part = 1; part <= 8; part++) {
        samples[part] = crossing(m, which, part == 8 ? to : from + (to - from) * part / 8);
        if (samples[part] * sign < 0) {
            last = part;
            break;
        }
    }
    for (part = 0; part <= last; part++) {
        double size = fabs(samples[part]);
        int low = part > 0 ? part - 1 : 0, high = part < last ? part + 1 : last, dips;
        if (part == 0) {
            dips = last > 0 && fabs(samples[1]) >= size && fabs(crossing(m, which, from + near)) < size;
        } else if (part == 8) {
            dips = fabs(samples[last - 1]) >= size && fabs(crossing(m, which, to - near)) < size;
        } else {
            dips = part != last && size <= fabs(samples[part - 1]) && size <= fabs(samples[part + 1]);
        }
        if (dips) {
            double left = low == 8 ? to : from + (to - from) * low / 8;
            double right = high == 8 ? to : from + (to - from) * high / 8;
            double changed = changed_near_zero(m, which, sign, left, right);
            if (IS_FINITE(changed)) {
                return first_with(m, which, sign, left, changed);
            }
        }
    }
    if (samples[last] * sign < 0) {
        double end = last == 8 ? to : from + (to - from) * last / 8;
        return first_with(m, which, sign, from + (to - from) * (last - 1) / 8, end);
    }
    return INFINITY;
}

/* The first switch by a function of the state within the step; else infinity. */
motion_CALLED double switch_within(const Motion *m) {
    double u[INPUTS + 1], signs[CROSSINGS + 1], first = INFINITY;
    int which;
    inputs_at(m, m->t, u);
    motion_crossings(m->t, m->x, u, m->p, signs);
    for (which = 0; which < CROSSINGS; which++) {
        /* A function that is zero at the start takes the sign just after it. */
        double sign = signs[which] == 0 ? crossing(m, which, m->t + (m->t_new - m->t) * 1e-9) : signs[which];
        first = at_most(first, first_change(m, which, sign, at_most(first, m->t_new)));
    }
    return IS_FINITE(first) ? at_most(first + 64 * EPSILON * fabs(first), m->t_new) : first;
}

/* The time at which a state leaves its range in the stretch; else infinity. */
motion_CALLED double left_at(const Motion *m, const double *rates_to, int range) {
    int i = range_state[range];
    double low = range_low[range], high = range_high[range], length = m->to - m->t;
    double old = m->k[0][i], rate = rates_to[i], slope, turned = INFINITY;
    double ahead = m->x[i] + length * old, behind = m->x_to[i] - length * rate;
    int is_out = m->x_to[i] < low || m->x_to[i] > high;
    int may_turn = old * rate < 0 && (ahead < low || ahead > high) && (behind < low || behind > high);
    int part;
    if (!is_out && !may_turn) {
        return INFINITY;
    }
    if (old * rate < 0) {
        turned = zero(m, -1 - i, 1, 0, m->t, m->to);
    }
    for (part = 0; part < 2; part++) {
        double from = part && IS_FINITE(turned) ? turned : m->t;
        double to = part ? m->to : turned, value;
        if (!IS_FINITE(to)) {
            continue;
        }
        value = component(m, to, i, &slope);
        if (value < low || value > high) {
            return zero(m, -1 - i, 0, value < low ? low : high, from, to);
        }
    }
    return INFINITY;
}

/* The case of a thread. */
motion_FUNCTION void one_case(int n, int i, const double *p, const double *start, const double *noise,
                              const double *times, int time_count, const double *pace, int pace_count,
                              int moments, const double *moment_times, const int *moment_places, double *rows,
                              double *ends, int *endings) {
    Motion m;
    double own_p[PARAMETERS + 1], values[MOST_FUNCTIONS] = {0}, u[INPUTS + 1], rates_to[STATES];
    double next_h = NAN, longest = INFINITY, previous_error = 1e-4, expected = -INFINITY;
    double steps = 0;
    int is_over = 0, ending = FINISHED, is_guess = 0, restart = 1, after_rejection = 0, slivers = -1;
    int next_time = 0, next_pace = 0, next_moment = 0, j, component_at_fault = 0;
    for (j = 0; j < PARAMETERS; j++) {
        own_p[j] = p[j * n + i];
    }
    for (j = 0; j < COLUMNS; j++) {
        rows[j * n + i] = NAN;
    }
    m.p = own_p;
    m.noise = noise;
    m.t = m.to = m.t_new = 0;
    m.h = 0;
    for (j = 0; j < STATES; j++) {
        m.x[j] = m.x_new[j] = m.x_to[j] = start[j * n + i];
        if (!IS_FINITE(m.x[j]) && !is_over) {
            is_over = 1;
            ending = NOT_FINITE;
            component_at_fault = j;
        }
    }
    for (j = 0; j < RANGES && !is_over; j++) {
        double x = m.x[range_state[j]];
        if (x < range_low[j] || x > range_high[j]) {
            is_over = 1;
            ending = OUT_OF_RANGE;
            component_at_fault = range_state[j];
        }
    }
    inputs_at(&m, 0, u);
    motion_events(0, m.x, u, own_p, values);
    for (j = 0; j < EVENTS; j++) {
        int holds = values[j] > 0;
        m.signs[j] = sign_of_number(values[j]);
        m.sizes[j] = 0;
        rows[event_column[j] * n + i] = holds;
        rows[(event_column[j] + 1) * n + i] = holds ? 0 : NAN;
        is_over += holds && event_stops[j];
    }
    motion_followed(0, m.x, u, own_p, values);
    for (j = 0; j < FOLLOWED; j++) {
        m.first[j] = values[j];
        m.best[j] = followed_kind[j] == MEAN ? 0 : (followed_kind[j] == SMALLEST ? -values[j] : values[j]);
        m.when[j] = m.largest[j] = 0;
        m.is_undefined[j] = !IS_FINITE(values[j]);
    }
    for (;;) {
        /* Values at given times up to the end of the stretch. */
        double recorded_t = NAN;
        while (next_moment < moments && moment_times[next_moment] <= m.to) {
            double t = moment_times[next_moment];
            if (t != recorded_t) {
                double x[STATES];
                state_at(&m, t, x);
                inputs_at(&m, t, u);
                motion_recorded(t, x, u, own_p, values);
                recorded_t = t;
            }
            rows[moment_places[2 * next_moment + 1] * n + i] = values[moment_places[2 * next_moment]];
            next_moment++;
        }
        /* The end of the stretch is the start of the next step. */
        m.t = m.to;
        for (j = 0; j < STATES; j++) {
            m.x[j] = m.x_to[j];
        }
        if (is_over || m.t >= T_END) {
            break;
        }
        if (restart) {
            derivative(&m, m.t, m.x, m.k[0]);
        }
        for (;;) {
            double h, error, power, factor, known, known_last, switched = INFINITY, left = INFINITY;
            int lands, needs_dense, is_start = restart;
            for (j = STATES - 1; restart && j >= 0; j--) {
                if (!IS_FINITE(m.k[0][j])) {
                    is_over = 1;
                    ending = NOT_FINITE;
                    component_at_fault = j;
                }
            }
            if (!is_over && steps >= MAX_STEPS) {
                is_over = 1;
                ending = TOO_MANY_STEPS;
            }
            if (is_over) {
                break;
            }
            while (next_time < time_count && times[next_time] <= m.t) {
                next_time++;
            }
            known = next_time < time_count ? times[next_time] : T_END;
            known_last = next_time < time_count ? before(known) : known;
            if (next_h != next_h) {
                is_guess = 1;
                next_h = first_step(&m, at_most(known - m.t, longest), known_last);
            }
            /* No pulse of a function of time is stepped over. */
            h = next_h;
            while (next_pace < pace_count && pace[2 * next_pace] + pace[2 * next_pace + 1] <= m.t) {
                next_pace++;
            }
            for (j = next_pace; j < pace_count && pace[2 * j] < m.t + h; j++) {
                if (pace[2 * j] + pace[2 * j + 1] > m.t) {
                    h = at_most(h, at_least(2 * pace[2 * j + 1], pace[2 * j] - m.t));
                }
            }
            /* A step that begins just before a switch ends just after it. */
            if (m.t <= expected && expected - m.t <= sliver(expected)) {
                h = at_most(h, expected - m.t + sliver(expected));
            }
            lands = m.t + 1.01 * h >= known;
            m.t_new = lands ? known : m.t + h;
            m.last = lands ? known_last : m.t_new;
            m.h = lands ? known - m.t : h;
            error = attempt(&m);
            steps++;
            power = pow(error, EXPONENT - INTEGRAL_GAIN * INTEGRAL_CORRECTION);
            if (!(error <= 1)) {
                double shorter;
                factor = IS_FINITE(error) ? within(SAFETY / power, SMALLEST_FACTOR, 1) : 0.25;
                after_rejection = 1;
                shorter = m.h * factor;
                if (m.t + 0.1 * shorter <= m.t) {
                    int stage;
                    is_over = 1;
                    ending = STEP_TOO_SMALL;
                    for (stage = NEW_RATES; stage > 0 && !IS_FINITE(error); stage--) {
                        const double *of = stage == NEW_RATES ? m.x_new : m.k[stage];
                        for (j = STATES - 1; j >= 0; j--) {
                            if (!IS_FINITE(of[j])) {
                                ending = NOT_FINITE;
                                component_at_fault = j;
                            }
                        }
                    }
                    break;
                }
                next_h = is_start && !is_guess ? NAN : shorter;
                longest = is_start && !is_guess ? shorter : INFINITY;
                restart = 0;
                continue;
            }
            if (!ERROR_USES_NEW_RATES) {
                derivative(&m, at_most(m.t_new, m.last), m.x_new, m.k[NEW_RATES]);
            }
            m.to = m.t_new;
            for (j = 0; j < STATES; j++) {
                m.x_to[j] = m.x_new[j];
                rates_to[j] = m.k[NEW_RATES][j];
            }
            needs_dense = EVENTS > 0 || FOLLOWED > 0 || CROSSINGS > 0;
            needs_dense |= next_moment < moments && moment_times[next_moment] < m.to;
            needs_dense |= RANGES > 0;
            if (needs_dense) {
                dense_output(&m);
            }
            if (CROSSINGS > 0) {
                switched = switch_within(&m);
                if (IS_FINITE(switched)) {
                    double length = switched - m.t, near = sliver(switched);
                    if (near < length && near < m.t_new - m.t - length) {
                        /* Stages beyond the switch corrupt the interpolant: a step that ends just before it is tried. */
                        expected = switched;
                        next_h = length - 0.5 * near;
                        restart = 0;
                        m.to = m.t;
                        for (j = 0; j < STATES; j++) {
                            m.x_to[j] = m.x[j];
                        }
                        continue;
                    }
                    m.to = switched;
                    interpolated(&m, switched, m.x_to);
                    if (CONSTRAINTS > 0) {
                        /* If this fails, the next step reports it. */
                        projected(&m, switched, m.x_to);
                    }
                    for (j = 0; j < STATES; j++) {
                        component(&m, switched, j, &rates_to[j]);
                    }
                }
            }
            if (slivers < 0 && IS_FINITE(switched)) {
                slivers = 0;
            }
            slivers = slivers >= 0 && m.to - m.t <= sliver(m.to) ? slivers + 1 : -1;
            /* Limits and events of the stretch. */
            for (j = 0; j < RANGES; j++) {
                double own = left_at(&m, rates_to, j);
                if (own < left) {
                    left = own;
                    component_at_fault = range_state[j];
                }
            }
            if (EVENTS > 0) {
                double stop = left, end;
                int ender = EVENTS;
                for (j = 0; j < EVENTS; j++) {
                    m.hits[j] = INFINITY;
                }
                walk(&m, OF_EVENTS, EVENTS);
                end = at_least(before(m.to), m.t);
                evaluated(&m, OF_EVENTS, m.to, values);
                for (j = 0; j < EVENTS; j++) {
                    point(&m, j, end, m.to, values[j]);
                    stop = event_stops[j] ? at_most(stop, m.hits[j]) : stop;
                }
                /* Of events at one time those after the one that ends the motion do not happen. */
                for (j = EVENTS - 1; j >= 0; j--) {
                    ender = event_stops[j] && m.hits[j] == stop ? j : ender;
                }
                for (j = 0; j < EVENTS; j++) {
                    double *happened = &rows[event_column[j] * n + i];
                    int is_hit = m.hits[j] < stop || (m.hits[j] == stop && j <= ender);
                    if (is_hit && IS_FINITE(m.hits[j]) && *happened == 0) {
                        *happened = 1;
                        rows[(event_column[j] + 1) * n + i] = m.hits[j];
                        is_over += event_stops[j] && m.hits[j] == stop;
                    }
                }
                if (is_over && stop <= left) {
                    m.to = stop;
                    interpolated(&m, stop, m.x_to);
                }
            }
            if (!is_over && IS_FINITE(left)) {
                is_over = 1;
                ending = OUT_OF_RANGE;
                m.to = left;
                interpolated(&m, left, m.x_to);
            } else if (!is_over && slivers > MOST_SLIVERS) {
                is_over = 1;
                ending = CHATTERING;
            }
            if (FOLLOWED > 0) {
                walk(&m, OF_FOLLOWED, FOLLOWED);
            }
            /* The next step. */
            factor = SAFETY / power * (INTEGRAL_GAIN == 0 ? 1 : pow(previous_error, INTEGRAL_GAIN));
            factor = within(factor, SMALLEST_FACTOR, after_rejection ? 1 : LARGEST_FACTOR);
            previous_error = at_least(error, 1e-4);
            after_rejection = 0;
            restart = lands || IS_FINITE(switched);
            /* A step shortened to end at a stop is no reason to propose a shorter one. */
            next_h = restart ? at_least(m.h * factor, next_h) : m.h * factor;
            is_guess = 0;
            for (j = 0; j < STATES; j++) {
                m.k[0][j] = m.k[NEW_RATES][j];
            }
            break;
        }
    }
    for (j = 0; j < FOLLOWED; j++) {
        double *to = &rows[followed_column[j] * n + i];
        double value = followed_kind[j] == SMALLEST ? -m.best[j] : m.best[j];
        if (followed_kind[j] == MEAN) {
            *to = m.is_undefined[j] ? NAN : (m.t > 0 ? value / m.t : m.first[j]);
        } else {
            *to = m.is_undefined[j] ? NAN : value;
            rows[(followed_column[j] + 1) * n + i] = m.is_undefined[j] ? NAN : m.when[j];
        }
    }
    if (AT_END > 0 && ending == FINISHED) {
        inputs_at(&m, m.t, u);
        motion_recorded(m.t, m.x, u, own_p, values);
        for (j = 0; j < AT_END; j++) {
            rows[end_column[j] * n + i] = values[end_place[j]];
        }
    }
    ends[i] = m.t;
    endings[i] = ending + 8 * component_at_fault;
}

/* Cases 0 to n - 1. Quantity k of case i is at [k * n + i] of p, start and rows; the numbers of its noises begin at
 * [i * noises_each] of noise, and place_of has the first and the count of its times and of its paces. */
motion_KERNEL void motion_cases(int n, int noises_each, int moments, const double *p, const double *start,
                                const double *noise, const double *times, const double *pace, const int *place_of,
                                const double *moment_times, const int *moment_places, double *rows, double *ends,
                                int *endings) {
    for (motion_EACH(i, n)) {
        const int *place = place_of + 4 * i;
        one_case(n, i, p, start, noise + (long long)i * noises_each, times + place[0], place[1], pace + 2 * (long long)place[2],
                 place[3], moments, moment_times, moment_places, rows, ends, endings);
    }
}
