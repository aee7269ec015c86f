"""What STRIPE drops where the chooser first allows it, over random cells and footprints.

Checks the exponent budget of `row_budget` (range_queries.md, "The chooser"): the sum of all dropped nodes (q >= 1) of the upper
family, and of the lower one, at the least conditional variance that the budget admits, in units of the error budget. Prints the
largest ratio for the constants of the code and for changed ones: their sensitivity.
"""
import numpy as np

TWO_PI2 = 2 * np.pi**2


def budget(kappa, slope, variance, conditional, threshold, reach=0.47, edge=0.4):
    sigma = np.sqrt(variance)
    density = max(1.0, 0.16 / np.sqrt(variance * conditional))
    x = max(0.32, min(abs(kappa - slope), abs(kappa + slope)) - reach / sigma)
    window = min(1.0, max(1.0, min(1.0 + edge / sigma, 3.2 * x)) / (np.pi * x))
    return threshold + np.log(window * density) / TWO_PI2


def a(m, f):
    return f if m == 0 else np.sin(np.pi * m * f) / (np.pi * m)


def dropped(c, u, tau):
    """Sum of the nodes with q >= 1: upper and lower family (lattice.rs in complex form)."""
    kappa, slope, variance, conditional, root, low, high, h_d, h_p = c
    f_d, f_p, open_, mid = 2 * h_d, 2 * h_p, high - low, 0.5 * (low + high)
    upper = lower = 0.0
    for q in range(1, 7):
        if TWO_PI2 * conditional * q * q > 30:
            break
        reach = np.sqrt(30 / TWO_PI2 / variance)
        centre = q * (root - slope)
        p = np.arange(np.ceil(centre - reach), np.floor(centre + reach) + 1) - q * root
        damping = 2 * np.exp(-TWO_PI2 * (variance * (p + q * slope) ** 2 + conditional * q * q))
        base = np.multiply.outer(u, p) + q * tau[:, None]
        x = -q * kappa - p
        upper = upper + (damping * a(q, f_d) * open_ * np.sinc(x * open_) * np.cos(2 * np.pi * (base + x * mid))).sum(1)
        for m in range(-2, q + 3):
            n = q - m
            gap = 1 - f_d if m == 0 else -a(abs(m), f_d)
            x = (n - m) * kappa - p
            lower = lower + (damping * gap * a(abs(n), f_p) * open_ * np.sinc(x * open_)
                             * np.cos(2 * np.pi * (base + x * mid - n * (kappa + root)))).sum(1)
    return max(np.abs(upper).max(), np.abs(lower).max())


def worst(epsilon, count, **changed):
    random = np.random.default_rng(7)
    threshold = np.log(0.9 / epsilon) / TWO_PI2
    least_teeth = max(threshold - 0.041, 0.05)
    ratios = []
    while len(ratios) < count:
        kappa = np.exp(random.uniform(np.log(1.5), np.log(55)))
        sigma = np.exp(random.uniform(np.log(0.02), np.log(3)))
        variance = sigma**2
        if 4 * kappa**2 * variance <= least_teeth:
            continue
        slope = random.choice([0.0, kappa, -kappa, random.normal() * kappa])
        # Least conditional variance that the budget admits.
        low_c, high_c = 1e-6, 2.0
        for _ in range(60):
            middle = np.sqrt(low_c * high_c)
            if middle > budget(kappa, slope, variance, middle, threshold, **changed):
                high_c = middle
            else:
                low_c = middle
        # The same footprint in barbule spacings; the query widens what is longer than 16 times its width.
        ratio = kappa * np.tan(random.uniform(np.radians(20), np.radians(45)))
        cross = slope * variance * ratio
        axes = np.linalg.eigvalsh([[variance * ratio**2, cross], [cross, high_c + slope**2 * variance]])
        if axes[1] > 256 * axes[0]:
            continue
        window = random.uniform(0.1, 0.95)
        low = random.uniform(0, 1 - window)
        h = random.uniform(0.05, 0.48, 2)
        cell = (kappa, slope, variance, high_c, random.uniform(-0.5, 0.5), low, low + window, *h)
        u, tau = random.random(60), random.random(60)
        ratios.append(dropped(cell, u, tau) / epsilon)
    ratios = np.array(ratios)
    return ratios.max(), np.sqrt((ratios**2).mean())


for epsilon in (0.01, 1 / 510, 0.001):
    print("budget %.5f: dropped at most %.2f budgets, RMS of the worst of 60 places %.2f (promised 2)"
          % (epsilon, *worst(epsilon, 1500)))
print("sensitivity at 1/510 (largest, RMS):")
for changed in ({"reach": 0.0}, {"reach": 0.3}, {"reach": 0.47}, {"reach": 0.6}, {"edge": 0.0}, {"edge": 0.4}, {"edge": 0.8}):
    print("  %s: %.2f, %.2f" % (changed, *worst(1 / 510, 1500, **changed)))
