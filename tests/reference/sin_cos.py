"""Coefficients of the polynomials in core/src/lane/sin_cos.rs, for half a turn around zero.

    pip install mpmath
    python tests/reference/sin_cos.py

sin x = x p(x^2), cos x = p(x^2): the first coefficients (1; 1 and -1/2) are those of the series, the others from an
interpolation at Chebyshev nodes. Printed with the largest error that their rounding to doubles leaves, evaluated exactly.
"""

from mpmath import cos, lu_solve, matrix, mp, mpf, pi, sin, sqrt

mp.dps = 60
END = (pi / 2) ** 2


def sine(y):
    return sin(sqrt(y)) / sqrt(y)


def cosine(y):
    return cos(sqrt(y))


def coefficients(value, fixed, count):
    free = count - len(fixed)
    nodes = [END / 2 * (1 + cos(pi * (2 * k + 1) / (2 * free))) for k in range(free)]
    rest = [(value(y) - sum(mpf(c) * y**k for k, c in enumerate(fixed))) / y ** len(fixed) for y in nodes]
    powers = matrix(free, free)
    for row, y in enumerate(nodes):
        for column in range(free):
            powers[row, column] = y**column
    return fixed + [float(c) for c in lu_solve(powers, matrix(rest))]


for name, value, fixed, count in [("SINE", sine, [1.0], 9), ("COSINE", cosine, [1.0, -0.5], 9)]:
    found = coefficients(value, fixed, count)
    error = max(
        abs(sum(mpf(c) * y**k for k, c in enumerate(found)) - value(y)) * (sqrt(y) if value is sine else 1)
        for y in (END * k / 2000 for k in range(1, 2001))
    )
    print(f"const {name}: [f64; {count}] = [")
    for c in found:
        print(f"    {c!r},")
    print(f"];  // error {float(error):.1e}")
