"""Constants of the fibre's lobes (scattering.md): series lengths, surface reflectance, widths, color blends."""
import numpy as np

ETA = 1.55
TWO_PI2 = 2 * np.pi**2


def fresnel(cosine, eta=ETA):
    c = np.clip(np.abs(cosine), 0, 1)
    t = np.sqrt(1 - (1 - c * c) / eta**2)
    s, p = (c - eta * t) / (c + eta * t), (eta * c - t) / (eta * c + t)
    return 0.5 * (s * s + p * p)


# Gauss-Legendre in gamma = asin h over half the width.
X, W = np.polynomial.legendre.leggauss(400)


def panel(low, high):
    g = 0.5 * (high - low) * (X + 1) + low
    return g, W * 0.5 * (high - low) * np.cos(g)


G, GW = panel(0, np.pi / 2)

print("1. mean surface reflectance over the width of a fibre, eta 1.55")
for theta, code in ((0.0, 0.0750), (0.5, 0.0850), (1.0, 0.157), (1.3, 0.3496)):
    f = (GW * fresnel(np.cos(theta) * np.cos(G))).sum()
    print("   theta %.1f: %.4f%s" % (theta, f, "  (sheen_tint: 0.157)" if theta == 1.0 else ""))

print("2. width of R of a round fibre: density cos(phi/2)/4 on -pi..pi, deviation sqrt(pi^2 - 8) = %.4f (code 1.37)"
      % np.sqrt(np.pi**2 - 8))

print("3. terms of a cosine series: error (L1 over the lobe sum's) of n = c / beta terms")


def lobes(kappa, theta):
    """Directions and weights of the rays of one fibre: R, and TT with TRT, or TRcT where the core is met."""
    root = np.sqrt(ETA**2 - np.sin(theta) ** 2) / np.cos(theta)
    out = []
    edge = np.arcsin(min(kappa * root, 1.0))
    for low, high, hit in ((0, edge, True), (edge, np.pi / 2, False)):
        if high - low < 1e-9:
            continue
        g, w = panel(low, high)
        inner = np.sin(g) / root
        gt = np.arcsin(inner)
        f = fresnel(np.cos(theta) * np.cos(g))
        out.append((w * f, 2 * g))
        if hit:
            out.append((w * (1 - f) ** 2 / (1 - f), 2 * (g - gt + np.arcsin(np.clip(inner / kappa, -1, 1)))))
        else:
            out.append((w * (1 - f) ** 2, 2 * (g - gt) - np.pi))
            out.append((w * (1 - f) ** 2 * f / (1 - f), 2 * g - 4 * gt))
    return out


CASES = [(lobes(k, t)) for k in (0.0, 0.5, 0.8) for t in (0.0, 0.8, 1.3)]
PHI = np.linspace(0, np.pi, 721)


def truncation(beta, terms):
    n = np.arange(1, 121)
    worst = 0.0
    for case in CASES:
        c = sum((w * np.cos(np.multiply.outer(n, phi))).sum(1) for w, phi in case) * np.exp(-0.5 * (n * beta) ** 2)
        total = sum(w.sum() for w, _ in case)
        wave = np.cos(np.multiply.outer(PHI, n))
        full = total + 2 * wave @ c
        cut = np.maximum(total + 2 * wave[:, :terms] @ c[:terms], 0)
        worst = max(worst, np.abs(full - cut).sum() / np.abs(full).sum())
    return worst


for factor in (1.6, 2.4):
    row = ["%.2f: m %2d, %.4f" % (b, int(np.ceil(factor / b)), truncation(b, int(np.ceil(factor / b)))) for b in (0.1, 0.2, 0.3, 0.45, 0.6)]
    print("   %.1f / beta:  %s" % (factor, "   ".join(row)))

print("4. terms by the chooser's threshold t = ln(0.9/epsilon)/(2 pi^2): the line through (0.004, 1.6) and (0.0004, 2.4)")
t1, t2 = (np.log(0.9 / e) / TWO_PI2 for e in (0.004, 0.0004))
slope = 0.8 / (t2 - t1)
print("   slope %.4f = 0.8 * 2 pi^2 / ln 10 (code 6.858, residual %+.1e); intercept %.4f (code -0.282, residual %+.1e)"
      % (slope, slope - 6.858, 1.6 - slope * t1, 1.6 - slope * t1 + 0.282))

print("5. blend of TT between its shapes at absorption 0 and 2: L1 error of the lobe, weighted by what is left of it")


def through(kappa, theta):
    root = np.sqrt(ETA**2 - np.sin(theta) ** 2) / np.cos(theta)
    edge = np.arcsin(min(kappa * root, 1.0))
    g, w = panel(edge, np.pi / 2)
    gt = np.arcsin(np.sin(g) / root)
    cos_t = np.sqrt(1 - np.sin(theta) ** 2 / ETA**2)
    f = fresnel(np.cos(theta) * np.cos(g))
    return w * (1 - f) ** 2, 2 * np.cos(gt) / cos_t, 2 * (g - gt) - np.pi


N = np.arange(1, 41)
# Larger cores let no light pass beside them at these inclinations.
THROUGH = [through(k, t) for k, t in ((0.0, 0.0), (0.0, 0.8), (0.0, 1.3), (0.3, 0.0), (0.3, 0.8), (0.5, 0.0))]
SIGMA = np.array([0.05, 0.1, 0.2, 0.4, 0.8, 1.5, 3.0])


def blend(weight):
    errors = []
    for a, length, phi in THROUGH:
        wave = np.cos(np.multiply.outer(N, phi))
        for beta in (0.2, 0.3, 0.45, 0.6):
            damp = np.exp(-0.5 * (N * beta) ** 2)
            shape = lambda s: damp * (a * np.exp(-s * length) * wave).sum(1) / (a * np.exp(-s * length)).sum()
            density = lambda c: 1 + 2 * np.cos(np.multiply.outer(PHI, N)) @ c
            clear, dense = shape(0.0), shape(2.0)
            for s in SIGMA:
                share = (a * np.exp(-s * length)).sum() / a.sum()
                w = weight(s)
                errors.append(share * np.abs(density(clear + w * (dense - clear)) - density(shape(s))).mean())
    return np.mean(errors), np.quantile(errors, 0.95)


for name, weight in (("2 s/(2 + s), at most 1.3 (code)", lambda s: min(2 * s / (2 + s), 1.3)),
                     ("1.5 s/(1 + s)", lambda s: 1.5 * s / (1 + s)),
                     ("s/2, at most 1.3", lambda s: min(0.5 * s, 1.3)), ("s/2, at most 2", lambda s: min(0.5 * s, 2.0)),
                     ("none: the clear shape", lambda s: 0.0)):
    print("   %-32s mean %.4f, 95 %% below %.4f" % (name, *blend(weight)))

print("6. round trips between core and surface: c of R(1-c)/(1-cR), fitted at R = 1/2, over the mean reflectance")
f = fresnel(np.cos(G))
y = lambda r: (GW * (1 - f) ** 2 * r / (1 - f * r)).sum()
half = y(0.5) / y(1.0)
c = (1 - 2 * half) / (1 - half)
worst = max(abs(y(r) / y(1.0) - r * (1 - c) / (1 - c * r)) for r in np.linspace(0, 1, 101))
print("   every core of 0.65 and more: c %.4f = %.3f times the mean F, largest error %.1e" % (c, c / (GW * f).sum(), worst))
