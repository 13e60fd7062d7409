"""Writes elementary.csv: elementary functions with fifty digits (mpmath), for the test of the same name.

A row holds the function, one or two arguments, the double that is nearest to the value, and how far the
value lies above it, in units of its last place.  Arguments are drawn where functions are hard: between the
pieces that formulas are made of, near zeros and limits, over all exponents.
"""

import math
import random

import mpmath
from mpmath import mpf

ROWS = 260
HALF_PI_DIGITS = 360  # as many as the largest doubles need


def log_uniform(low, high, signed=True):
    value = math.exp(random.uniform(math.log(low), math.log(high)))
    return -value if signed and random.random() < 0.5 else value


def pick(*parts):
    """One of the draws, each as probable as its weight."""
    weights, draws = zip(*parts)
    return lambda: random.choices(draws, weights)[0]()


def uniform(low, high):
    return lambda: random.uniform(low, high)


def spread(low, high, signed=True):
    return lambda: log_uniform(low, high, signed)


def near_zero_of_sine():
    quarters = random.randint(1, 10 ** random.randint(1, 8))
    x = float(quarters * mpmath.pi / 2)
    return x + random.randint(-2, 2) * math.ulp(x)


def near_one():
    return random.choice([-1, 1]) * (1 - log_uniform(1e-16, 0.5, signed=False))


angle = pick((7, uniform(-7, 7)), (3, uniform(-1000, 1000)), (3, spread(1e-300, 2.0**30)),
             (4, near_zero_of_sine), (3, spread(2.0**29, 1e300)))
fraction = pick((7, uniform(-1, 1)), (2, spread(1e-310, 1)), (2, near_one))
argument = pick((6, uniform(-4, 4)), (4, spread(1e-310, 700)))

UNARY = {
    "sin": angle, "cos": angle, "tan": angle,
    "asin": fraction, "acos": fraction,
    "atan": pick((6, uniform(-4, 4)), (4, spread(1e-310, 1e300))),
    "sinh": argument, "cosh": argument, "tanh": pick((6, uniform(-2, 2)), (4, spread(1e-310, 30))),
    "exp": pick((4, uniform(-2, 2)), (4, uniform(-745, 709.7)), (2, spread(1e-20, 700))),
    "ln": pick((5, uniform(0.5, 2)), (3, spread(1e-320, 1e308, signed=False)), (2, uniform(0, 20))),
}


def power_of(x):
    """x, and an exponent for which the power is a double."""
    return x, random.uniform(-700, 700) / abs(float(mpmath.log(x)))


BINARY = {
    "powf": pick((4, lambda: (random.uniform(0, 10), random.uniform(-10, 10))),
                 (2, lambda: power_of(1 + log_uniform(1e-15, 0.4))),
                 (2, lambda: power_of(log_uniform(1e-320, 1e308, signed=False))),
                 (2, lambda: (random.uniform(-10, 10), float(random.randint(-20, 20))))),
    "atan2": pick((6, lambda: (random.uniform(-2, 2), random.uniform(-2, 2))),
                  (3, lambda: (log_uniform(1e-320, 1e308), log_uniform(1e-320, 1e308)))),
}
# What came out worst in a search of 100,000 arguments each.
WORST = {
    "sin": [(-932.2847176802111,)], "cos": [(-3.9531330799594775,), (487.7508642566097,)],
    "tan": [(168.86787267746377,), (-360.5259415834547,), (91.106186954104,)],
    "asin": [(-0.3905894689618914,)], "acos": [(0.9221653373433083,)], "atan": [(-0.4447703936945171,)],
    "sinh": [(-0.8617249446471336,)], "tanh": [(0.994954452366204,)], "ln": [(1.394888257123074,)],
    "powf": [(0.9999250596801164, -8523044.06391009), (1.4462789206678073, -1410.7740306659077)],
}


def exact(name, arguments):
    mpmath.mp.dps = HALF_PI_DIGITS if name in ("sin", "cos", "tan") else 50
    function = {"powf": mpmath.power, "ln": mpmath.log}.get(name) or getattr(mpmath, name)
    return function(*map(mpf, arguments))


def row(name, arguments):
    value = exact(name, arguments)
    nearest = float(value)
    if math.isinf(nearest):
        return None
    above = (value - mpf(nearest)) / mpf(math.ulp(nearest))
    numbers = [repr(argument) for argument in arguments] + [""] * (2 - len(arguments))
    return ",".join([name, *numbers, repr(nearest), mpmath.nstr(above, 4)])


def main():
    random.seed(1)
    lines = ["function,x,second argument,nearest double,units above it"]
    for name, draw in {**UNARY, **BINARY}.items():
        drawn = [draw() for _ in range(ROWS)]
        if name in UNARY:
            drawn = [(x,) for x in drawn]
        rows = [row(name, arguments) for arguments in drawn + WORST.get(name, [])]
        lines += [line for line in rows if line]
    with open("elementary.csv", "w", encoding="ascii") as file:
        file.write("\n".join(lines) + "\n")


main()
