// The unicycle as a person types it: equations (36) and (86) of the steering paper as printed after
// correction; one sine and cosine per angle, common squares named, nothing else rearranged.
#include <math.h>

void hand_unicycle_rates(const double *restrict x, const double *restrict u, const double *restrict p,
                         double *restrict out) {
    const double w1 = x[0], w2 = x[1], w3 = x[2], s = x[3], psi = x[6], theta = x[7], r = x[9];
    const double m = p[0], m0 = p[1], R = p[2], g = p[3], F = u[0];
    const double st = sin(theta), ct = cos(theta), sp = sin(psi), cp = cos(psi), tn = st / ct;
    const double rr = r * r, RR = R * R;
    const double d1 = 5 * m * RR + 4 * m0 * rr, d2 = 3 * m * RR + 2 * m0 * RR + 12 * m0 * rr;
    out[0] = (4 * m0 * R * r * w1 * w1 - (m * RR + 4 * m0 * rr) * tn * w3 * w3 - 8 * m0 * r * w1 * s +
              2 * R * (3 * m * R + 2 * m0 * r * tn) * w2 * w3 - 4 * m0 * g * r * ct + 4 * m * g * R * st +
              4 * R * F) / d1;
    out[1] = 2 * (-2 * m0 * R * r * w1 * w2 - (m * RR + m0 * RR + 4 * m0 * rr) * w1 * w3 +
                  2 * m0 * R * w3 * s) / d2;
    out[2] = (-2 * (3 * m + 2 * m0) * RR * w1 * w2 +
              (3 * m * RR * tn + 2 * m0 * (RR * tn + 2 * R * r + 6 * rr * tn)) * w1 * w3 -
              24 * m0 * r * w3 * s) / d2;
    out[3] = ((5 * m * RR + 4 * m0 * (RR + rr)) * r * w1 * w1 +
              (5 * m * RR * r - 4 * m0 * R * rr * tn + 4 * m0 * rr * r - m * RR * R * tn) * w3 * w3 -
              8 * m0 * R * r * w1 * s + R * (m * RR + 4 * m0 * (R * r * tn - rr)) * w2 * w3 -
              (m * RR + 4 * m0 * rr) * g * st - 4 * m0 * g * R * r * ct +
              (5 * m / m0 * RR + 4 * RR + 4 * rr) * F) / d1;
    out[4] = w1 * R * sp * ct + w2 * R * cp;
    out[5] = -w1 * R * cp * ct + w2 * R * sp;
    out[6] = w3 / ct;
    out[7] = w1;
    out[8] = w2 - w3 * tn;
    out[9] = s;
}
