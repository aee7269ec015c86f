"""Constants of the range query's chooser that follow from closed forms (range_queries.md, "The chooser")."""
import numpy as np
from scipy.optimize import brentq
from scipy.stats import norm

TWO_PI2 = 2 * np.pi**2


def threshold(epsilon):
    return np.log(0.9 / epsilon) / TWO_PI2


print("exponent 2 pi^2 = %.7f (code: 19.7392088)" % TWO_PI2)

# MEAN drops the harmonics of both directions, each at most (2/pi) exp(-2 pi^2 v) = (2/pi) epsilon / c at the threshold.
for c in (0.849, 0.9, 1.0):
    print("numerator %.3f: MEAN drops at most %.3f budgets (promised 1.5)" % (c, 4 / np.pi / c))
print("least numerator that keeps the promise: 8/(3 pi) = %.4f; the code takes 0.9" % (8 / (3 * np.pi)))

print("presets of NEAR change where the budget falls below")
for epsilon, code in ((0.0075, 0.2425), (0.0015, 0.324), (0.00075, 0.359), (0.0004, 0.391)):
    print("  %.5f: threshold %.4f (code %.4f, residual %+.1e)" % (epsilon, threshold(epsilon), code, threshold(epsilon) - code))

# A tooth of the overlap: first harmonic 2 (1/pi)^2; half a budget of it may be left.
tooth = 2 / np.pi**2
offset = np.log(0.5 * 0.9 / tooth) / TWO_PI2
print("tooth amplitude 2/pi^2 = %.4f; threshold less ln(0.45/tooth)/(2 pi^2) = %.5f (code 0.041, residual %+.1e)"
      % (tooth, offset, offset - 0.041))
print("  with the tooth rounded to 0.2: %.5f (residual %+.1e)" % (np.log(0.45 / 0.2) / TWO_PI2, np.log(0.45 / 0.2) / TWO_PI2 - 0.041))
print("  its floor of 0.05 is met by budgets above %.2f only; budgets end at 0.05" % (0.9 * np.exp(-TWO_PI2 * 0.091)))

# Sum of all damped nodes of a lattice of unit density outside the ellipse A P^2 + s q^2 = E:
#   integral of pi/sqrt(A s) exp(-2 pi^2 r) dr from E = exp(-2 pi^2 E) / (2 pi sqrt(A s)).
print("density of nodes: 1/(2 pi) = %.5f (code 0.16, residual %+.1e)" % (1 / (2 * np.pi), 1 / (2 * np.pi) - 0.16))
print("window: least distance 1/pi = %.4f (code 0.32), slope pi = %.4f (code 3.2), both rounded up" % (1 / np.pi, np.pi))

# MEAN and STRIPE are never left to NEAR where its gaps would run out.
print("reach of 3 sigmas at variance 25: %d gaps of at most 32" % (2 * 3 * 5 + 1))

# A line leaves a tail beyond z sigmas with the variance 1 + z r - r^2, r = phi(z)/Phi(-z).
variance = lambda z: 1 + z * (norm.pdf(z) / norm.sf(z)) - (norm.pdf(z) / norm.sf(z)) ** 2
edge = brentq(lambda z: variance(z) - 0.25, -3, 3)
print("a tail has a quarter of the variance beyond %.2f sigmas: 4 budgets of variance serve tails of %.0f %% and more" % (edge, 100 * norm.sf(edge)))
for z in (0.0, 1.0, 2.0):
    print("  beyond %.0f sigmas: variance %.3f of the whole, mass %.3f" % (z, variance(z), norm.sf(z)))
