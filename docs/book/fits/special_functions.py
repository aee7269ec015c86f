"""Polynomials and seams of the functions of one variable (range_queries.md, scattering.md): prints their largest errors."""
import numpy as np
from scipy.special import erf, i0e

x = np.linspace(-0.25, 0.25, 200001)
z = x * x
sine = x * (2 * np.pi + z * (-41.341702 + z * (81.60525 + z * (-76.70586 + z * (42.05869 + z * -15.094643)))))
print("sine_turns: error %.1e (documented 6e-8)" % np.abs(sine - np.sin(2 * np.pi * x)).max())
taylor = [-((2 * np.pi) ** 3) / 6, (2 * np.pi) ** 5 / 120, -((2 * np.pi) ** 7) / 5040, (2 * np.pi) ** 9 / 362880, -((2 * np.pi) ** 11) / 39916800]
print("  Taylor coefficients:", " ".join("%.5f" % t for t in taylor))

x = np.linspace(0, 6, 200001)
t = 1 / (1 + 0.3275911 * x)
p = ((((1.061405429 * t - 1.453152027) * t + 1.421413741) * t - 0.284496736) * t + 0.254829592) * t
print("error_function: error %.1e (Abramowitz and Stegun 7.1.26: 1.5e-7)" % np.abs(1 - p * np.exp(-x * x) - erf(x)).max())

x = np.linspace(0, 1, 200001)
p = np.polyval([-0.0012624911, 0.0066700901, -0.0170881256, 0.030891881, -0.0501743046, 0.0889789874, -0.2145988016, 1.570796305], x)
print("arc_sine: error %.1e (Abramowitz and Stegun 4.4.46: 2e-8)" % np.abs(np.pi / 2 - np.sqrt(1 - x) * p - np.arcsin(x)).max())

x = np.concatenate([np.linspace(0, 3.75, 50001)[:-1], np.geomspace(3.75, 1e4, 50001)])
s = np.minimum(x / 3.75, 1) ** 2
low = np.polyval([0.0045813, 0.0360768, 0.2659732, 1.2067492, 3.0899424, 3.5156229, 1.0], s) * np.exp(-x)
r = 3.75 / np.maximum(x, 3.75)
high = np.polyval([0.00392377, -0.01647633, 0.02635537, -0.02057706, 0.00916281, -0.00157565, 0.00225319, 0.01328592, 0.39894228], r) / np.sqrt(np.maximum(x, 3.75))
print("i0e: relative error %.1e (Abramowitz and Stegun 9.8.1, 9.8.2: 5e-7)" % np.abs(np.where(x < 3.75, low, high) / i0e(x) - 1).max())

below = np.polyval([0.0122650664, 0.0162134503, 0.110501287, 0.284803712, 0.342285443, 1], x)
above = np.polyval([0.0770636847, 0.0825281505, 0.66658347, 1.49792471, 2.47513668, 2.34192582, 1], x)
print("short_bessel: relative error %.1e (documented 4e-6)" % np.abs(np.sqrt(below / above) / i0e(x) - 1).max())
x = np.linspace(-8, 8, 200001)
power = x * np.polyval([0.000911244969, -0.106177326, -2.30172713], x * x)
print("normal_share: error %.1e (documented 2e-5)" % np.abs(1 / (1 + 2**power) - 0.5 * (1 + erf(x / np.sqrt(2)))).max())


def staircase(x, v):
    """Wrapped Gaussian's integral: all images."""
    j = np.arange(-8, 9)
    n = np.floor(x + 0.5)
    return n + 0.5 * sum(erf((x - n - k) / np.sqrt(2 * v)) + np.sign(k) for k in j)


def sharp(x, v):
    n = np.floor(x + 0.5)
    return n + 0.5 * erf((x - n) / np.sqrt(2 * v))


def series(x, v, terms=4):
    q = np.exp(-2 * np.pi**2 * v)
    return x + sum(q ** (n * n) * np.sin(2 * np.pi * n * x) / (np.pi * n) for n in range(1, terms + 1))


x = np.linspace(-0.5, 0.5, 4001)[1:-1]
print("staircase: largest error of the nearest step and of four harmonics around the seam")
for v in (0.012, 0.0145, 0.017, 0.0225):
    a, b = np.abs(sharp(x, v) - staircase(x, v)).max(), np.abs(series(x, v) - staircase(x, v)).max()
    print("  variance %.4f: step %.1e, harmonics %.1e%s" % (v, a, b, "  <- seam (code 0.0145)" if v == 0.0145 else ""))
grid = np.linspace(0.010, 0.020, 201)
best = min(grid, key=lambda v: max(np.abs(sharp(x, v) - staircase(x, v)).max(), np.abs(series(x, v) - staircase(x, v)).max()))
print("  the seam of least error lies at %.5f" % best)
print("  straight line beyond 0.42: error %.1e" % (np.exp(-2 * np.pi**2 * 0.42) / np.pi))
