"""What contour feathers let through (undercoat.md, "When it is drawn at all"): the 1.07 of `cover_transmittance`.

Rounded cards on a flat skin, rooted on a hexagonal lattice and laid along one direction, K deep on the mean (K counts 0.75 of a card's
length times width): vanes of opacity 0.9 to 0.98, their lower halves downy (0.55), soft rims. Prints the mean transmittance for orderly and for disordered coats.
"""
import numpy as np


def coat(k, yaw, shift, missing, seed, size=60.0, rays=6000, open_base=0.55, base=0.5):
    random = np.random.default_rng(seed)
    length, width = 10.0, 6.0
    # K = n L W 0.75 / area.
    pitch = np.sqrt(length * width * 0.75 / k * 2 / np.sqrt(3))
    rows = int(size / (pitch * np.sqrt(3) / 2)) + 1
    columns = int(size / pitch) + 1
    y, x = np.mgrid[0:rows, 0:columns].astype(float)
    x = (x + 0.5 * (y % 2)) * pitch
    y = y * pitch * np.sqrt(3) / 2
    x, y = x.ravel(), y.ravel()
    x += random.normal(0, shift * pitch, x.size)
    y += random.normal(0, shift * pitch, x.size)
    keep = random.random(x.size) >= missing
    x, y = x[keep], y[keep]
    turn = random.normal(0, np.radians(yaw), x.size)
    scale = 1 + random.normal(0, 0.06, x.size)
    opacity = random.uniform(0.9, 0.98, x.size)
    margin = 1.3 * length
    px, py = random.uniform(margin, size - margin, (2, rays))
    through = np.ones(rays)
    for i in range(x.size):
        dx, dy = px - x[i], py - y[i]
        near = (np.abs(dx) < length) & (np.abs(dy) < 1.2 * length)
        if not near.any():
            continue
        c, s = np.cos(turn[i]), np.sin(turn[i])
        v = (dy[near] * c - dx[near] * s) / (length * scale[i])
        u = (dx[near] * c + dy[near] * s) / (0.5 * width * scale[i])
        # A rounded blade of 0.75 length times width.
        half = 0.75 / 0.816 * np.where((v >= 0) & (v <= 1), np.minimum(1, 0.3 + 2.5 * v) * np.sqrt(np.clip(1 - np.clip((v - 0.6) / 0.4, 0, 1) ** 2, 0, 1)), 0)
        rim = np.clip((half - np.abs(u)) / 0.1 + 0.5, 0, 1) * (half > 0)
        vane = np.where(v < base, open_base, opacity[i])
        through[near] *= 1 - rim * vane
    return through


print("mean transmittance; exp(-1.07 K) beside it")
print("   K    orderly  12 deg, 30 %%   5 %% missing   exp(-1.07 K)")
rows = []
for k in (1, 2, 3, 4, 6):
    values = [np.mean([coat(k, *case, seed).mean() for seed in range(4)]) for case in ((3, 0.08, 0.0), (12, 0.3, 0.0), (3, 0.08, 0.05))]
    rows.append((k, values))
    print("   %d    %.4f   %.4f         %.4f         %.4f" % (k, *values, np.exp(-1.07 * k)))
for name, i in (("disordered", 1), ("5 % missing", 2)):
    slope = [-np.log(v[i]) / k for k, v in rows]
    print("-ln V / K, %s: %s" % (name, " ".join("%.3f" % s for s in slope)))
