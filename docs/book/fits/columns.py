"""Closed fits of light in a layered coat (undercoat.md, "Light"): sky through a column, H function, steps, highlights."""
import numpy as np
from scipy.optimize import least_squares
from scipy.special import expn, gammaln

C = np.linspace(0, 8, 1601)

print("1. uniform sky through a column of depth C")
irradiance = np.exp(-0.8745 * C) / (1 + 0.9206 * C)
print("   2 E3: exp(-.8745 C)/(1 + .9206 C): largest error %.4f" % np.abs(irradiance - 2 * expn(3, C)).max())
visibility = np.exp(-C) / (1 + 1.0071 * C + 0.488 * np.sqrt(C))
print("   E2: exp(-C)/(1 + 1.0071 C + .488 sqrt C): largest error %.4f" % np.abs(visibility - expn(2, C)).max())


def aligned(c):
    """Fibres along the normal: what a ray at the cosine mu meets is C tan(theta)."""
    mu = (np.arange(20000) + 0.5) / 20000
    tan = np.sqrt(1 - mu * mu) / mu
    return np.array([np.exp(-x * tan).mean() for x in c])


coarse = np.linspace(0, 8, 161)
true = aligned(coarse)
form = lambda p, c: 1 / (1 + p[0] * c + p[1] * c * c + p[2] * np.sqrt(c))
code = np.array([1.8585, 0.7816, 0.4527])
print("   along the normal: 1/(1 + 1.8585 C + .7816 C^2 + .4527 sqrt C): largest error %.4f" % np.abs(form(code, coarse) - true).max())


def minimax(f, truth, c, start):
    p = np.array(start, float)
    for k in (2, 4, 8, 16, 32):
        p = least_squares(lambda q: 100 * np.sign(f(q, c) - truth) * np.abs(10 * (f(q, c) - truth)) ** (k / 2), p).x
    return p, np.abs(f(p, c) - truth).max()


for name, f, truth, start in (
        ("2 E3", lambda p, c: np.exp(-p[0] * c) / (1 + p[1] * c), 2 * expn(3, coarse), [0.8745, 0.9206]),
        ("E2", lambda p, c: np.exp(-p[0] * c) / (1 + p[1] * c + p[2] * np.sqrt(c)), expn(2, coarse), [1.0, 1.0071, 0.488]),
        ("along the normal", form, true, code)):
    least = least_squares(lambda p: f(p, coarse) - truth, start).x
    p, e = minimax(f, truth, coarse, start)
    print("   refit of %s: least squares %s (largest %.4f), smallest largest error %.4f at %s"
          % (name, np.round(least, 4), np.abs(f(least, coarse) - truth).max(), e, np.round(p, 4)))

print("2. Chandrasekhar's H, isotropic scattering: relative error of Hapke's forms")
X, W = np.polynomial.legendre.leggauss(200)
X, W = 0.5 * (X + 1), 0.5 * W
for albedo in (0.5, 0.8, 0.95, 1.0):
    h = np.ones_like(X)
    root = np.sqrt(1 - albedo)
    for _ in range(4000):
        # 1/H(mu) = sqrt(1 - a) + (a/2) integral of x H(x)/(mu + x).
        h = 0.5 * (h + 1 / (root + 0.5 * albedo * ((W * h * X)[None, :] / (X[:, None] + X[None, :])).sum(1)))
    r0 = (1 - root) / (1 + root)
    of_2002 = 1 / (1 - albedo * X * (r0 + 0.5 * (1 - 2 * r0 * X) * np.log((1 + X) / X)))
    of_1981 = (1 + 2 * X) / (1 + 2 * X * root)
    print("   albedo %.2f: 2002 %.4f, 1981 %.4f" % (albedo, np.abs(of_2002 / h - 1).max(), np.abs(of_1981 / h - 1).max()))

print("3. place in a step of depth d where its light is met: mean place 1/d - 1/(exp d - 1) = 1/(2 + d/3 + d^2/18 + ...)")
d = np.linspace(1e-3, 4, 4001)
mean = 1 / d - 1 / np.expm1(d)
print("   largest error to depth 4: %.4f" % np.abs(1 / (2 + d / 3 + d * d / 18) - mean).max())

print("4. integral of cos^p over half a turn: sqrt(2 pi/(p + 1/2))")
p = np.geomspace(1, 1e4, 2001)
exact = np.sqrt(np.pi) * np.exp(gammaln((p + 1) / 2) - gammaln(p / 2 + 1))
print("   largest relative error for p >= 1: %.4f" % np.abs(np.sqrt(2 * np.pi / (p + 0.5)) / exact - 1).max())

print("5. Kajiya-Kay: integral of sqrt(sin^2 + e^2 cos^2) over the sphere, against 2 pi (e + asin(q)/q), q^2 = 1 - e^2")
x = (np.arange(200000) + 0.5) / 100000 - 1
for e in (0.0, 0.15, 0.5, 0.85, 0.999):
    q = np.sqrt(1 - e * e)
    print("   e %.3f: %.5f, closed %.5f" % (e, 2 * np.pi * np.sqrt(1 - x * x + e * e * x * x).mean() * 2, 2 * np.pi * (e + np.arcsin(q) / q)))

print("6. the ray is cut at a mean depth of 7: what lies behind counts %.5f; it stops at 0.003, depth %.2f" % (np.exp(-7), -np.log(0.003)))
