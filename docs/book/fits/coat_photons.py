"""Correction of the albedo in a thin coat over a dark skin (undercoat.md, "Light"): the 0.13 of `scattering_albedo`.

Photons in a uniform slab that scatters isotropically, over a diffuse skin, against single scattering times H(eye) H(light).
"""
import numpy as np
from scipy.optimize import minimize_scalar

X, W = np.polynomial.legendre.leggauss(64)
X, W = 0.5 * (X + 1), 0.5 * W


def photons(depth, albedo, skin, mu, count=400_000, seed=1):
    """Share of the light that comes back."""
    random = np.random.default_rng(seed)
    tau = np.zeros(count)
    cosine = np.full(count, -mu)
    weight = np.ones(count)
    back = 0.0
    for _ in range(2000):
        tau = tau - cosine * random.exponential(size=tau.size)
        out = tau <= 0
        back += weight[out].sum()
        ground = tau >= depth
        tau = np.minimum(tau, depth)
        weight = np.where(ground, weight * skin, weight * albedo)
        fresh = np.where(ground, np.sqrt(random.random(tau.size)), 2 * random.random(tau.size) - 1)
        keep = ~out & (weight > 1e-3)
        tau, cosine, weight = tau[keep], fresh[keep], weight[keep]
        if tau.size == 0:
            break
    return back / count


def hapke_1981(mu, a):
    return (1 + 2 * mu) / (1 + 2 * mu * np.sqrt(1 - a))


def h(mu, a):
    """Hapke 2002: what the code uses."""
    r = np.sqrt(1 - a)
    r0 = (1 - r) / (1 + r)
    return 1 / (1 - a * mu * (r0 + 0.5 * (1 - 2 * r0 * mu) * np.log((1 + mu) / mu)))


def model(depth, albedo, skin, mu, k, multiple=True, form=h):
    a = albedo * (1 - k * (1 - skin) * np.exp(-depth))
    through = np.exp(-depth * (1 / X + 1 / mu))
    many = form(X, a) * form(mu, a) if multiple else 1.0
    radiance = albedo / 4 * many * (1 - through) * mu / (mu + X) + skin * through * mu
    return 2 / mu * (W * X * radiance).sum()


CASES = [(d, a, s, np.cos(np.radians(t))) for d in (1.5, 4.0) for a in (0.5, 0.8, 0.95) for s in (0.1, 0.3, 0.6) for t in (30, 65)]
TRUE = [photons(*case) for case in CASES]


def errors(k, chosen=None, form=h):
    return np.array([model(*c, k, form=form) / t - 1 for c, t in zip(CASES, TRUE) if chosen is None or chosen(c)])


print("coefficient   RMS     largest relative error of the coat's albedo (36 cases)")
for k in (0.0, 0.05, 0.1, 0.13, 0.16, 0.2, 0.3):
    e = errors(k)
    print("   %.2f       %.4f   %+.4f" % (k, np.sqrt((e**2).mean()), e[np.abs(e).argmax()]))
for name, chosen in (("all", None), ("skin 0.3", lambda c: c[2] == 0.3), ("skin 0.3, albedo 0.95", lambda c: c[2] == 0.3 and c[1] == 0.95),
                     ("albedo 0.95, depth 1.5", lambda c: c[0] == 1.5 and c[1] == 0.95)):
    best = minimize_scalar(lambda k: (errors(k, chosen) ** 2).mean(), bounds=(0, 0.6), method="bounded").x
    worst = minimize_scalar(lambda k: np.abs(errors(k, chosen)).max(), bounds=(0, 0.6), method="bounded").x
    print("best for %-24s least squares %.3f, smallest largest error %.3f (code 0.13)" % (name + ":", best, worst))
for name, chosen in (("skin 0.3", lambda c: c[2] == 0.3), ("skin 0.3, albedo 0.95, depth 1.5", lambda c: c[0] == 1.5 and c[2] == 0.3 and c[1] == 0.95)):
    best = minimize_scalar(lambda k: (errors(k, chosen, hapke_1981) ** 2).mean(), bounds=(0, 0.6), method="bounded").x
    print("with Hapke's H of 1981, %s: least squares %.3f" % (name, best))
e = np.array([model(*c, 0.13) / t - 1 for c, t in zip(CASES, TRUE) if c[0] == 4.0])
print("depth 4, all skins, with 0.13: largest relative error %.3f" % np.abs(e).max())
print("single scattering alone, depth 4, skin 0.3: truth over it")
for c, t in zip(CASES, TRUE):
    if c[0] == 4.0 and c[2] == 0.3:
        print("   albedo %.2f, light at %2.0f degrees: %.2f times; with H H %.3f" % (c[1], np.degrees(np.arccos(c[3])), t / model(*c, 0, False), model(*c, 0.13) / t))
