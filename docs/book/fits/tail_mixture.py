"""Three Gaussians for the tail of a Gaussian beyond z sigmas, z = 0..2.5 (range_queries.md, "Footprints cut by a line").

In units of the mean distance from the line, masses, means and deviations of the first two are linear in z; the third takes what is
left, so that mass, mean and variance of the tail are exact. Least squares of the density, which by Parseval's theorem is the mean
error over all frequencies of a pattern under it. Prints the constants of the code beside the fit, and both residuals.
"""
import numpy as np
from scipy.optimize import least_squares
from scipy.stats import norm

CODE = np.array([0.143, 0.01, 0.366, 0.0125, 0.16, -0.008, 0.608, -0.0145, 0.117, -0.004, 0.331, -0.0015])
NAMES = "w0 w0' w1 w1' m0 m0' m1 m1' s0 s0' s1 s1'".split()
Z = np.linspace(0, 2.5, 11)
STEP = 0.01
X = np.arange(-2, 8, STEP) + STEP / 2


def mixture(p, z):
    """Mean distance of the tail, and (mass, mean, deviation) of the three Gaussians in units of it."""
    w0, w1 = p[0] + p[1] * z, p[2] + p[3] * z
    m0, m1 = p[4] + p[5] * z, p[6] + p[7] * z
    s0, s1 = p[8] + p[9] * z, p[10] + p[11] * z
    reach = norm.pdf(z) / norm.sf(z) - z
    w2 = 1 - w0 - w1
    m2 = (1 - w0 * m0 - w1 * m1) / w2
    square = (1 - z * reach) / reach**2
    rest = (square - w0 * (m0**2 + s0**2) - w1 * (m1**2 + s1**2)) / w2 - m2**2
    s2 = np.sqrt(np.clip(rest, 0.1, 2.0))
    return reach, [(w0, m0, s0), (w1, m1, s1), (w2, m2, s2)]


def error(parts, z, reach):
    found = sum(w * norm.pdf((X - m) / s) / s for w, m, s in parts)
    return found - np.where(X > 0, norm.pdf(z + X * reach) * reach / norm.sf(z), 0.0)


def residual(p):
    out = []
    for z in Z:
        reach, parts = mixture(p, z)
        out.append(error(parts, z, reach))
    return np.concatenate(out)


def one():
    out = []
    for z in Z:
        reach = norm.pdf(z) / norm.sf(z) - z
        out.append(error([(1.0, 1.0, np.sqrt((1 - z * reach) / reach**2 - 1))], z, reach))
    return np.concatenate(out)


def rms(e):
    return np.sqrt((e**2).mean())


fit = least_squares(residual, CODE).x
print("RMS error of the density: code %.5f, best fit %.5f (%.2f %% less), one Gaussian of the same moments %.5f"
      % (rms(residual(CODE)), rms(residual(fit)), 100 * (1 - rms(residual(fit)) / rms(residual(CODE))), rms(one())))
print("parameter     code      fit  residual")
for name, c, f in zip(NAMES, CODE, fit):
    print("  %-4s    %8.4f %8.4f  %+8.4f" % (name, c, f, c - f))
