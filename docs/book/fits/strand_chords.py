"""Segments of a strand (undercoat.md, "Strands"): the chord error of the cubic of `strand_curve`, its 0.42, and four bends."""
import numpy as np


def direction(bend, z, lay):
    d = np.array([0, 0, 1.0]) * (1 - bend * z) + lay * bend * z
    return d / np.linalg.norm(d)


def curve(bend, lay):
    n = np.array([0, 0, 1.0])
    middle = direction(bend, 2 / 3, lay) * 2 / 3
    points = np.array([np.zeros(3), n / 3, middle, middle + direction(bend, 1.0, lay) / 3])
    s = np.linspace(0, 1, 2001)
    at = bezier(points, s)
    return points / np.linalg.norm(np.diff(at, axis=0), axis=1).sum()


def bezier(p, s):
    r = 1 - s[:, None]
    s = s[:, None]
    return p[0] * r**3 + 3 * p[1] * r * r * s + 3 * p[2] * r * s * s + p[3] * s**3


def chord(p, n):
    worst = 0.0
    for i in range(n):
        at = bezier(p, (i + np.linspace(0, 1, 65)) / n)
        ab = at[-1] - at[0]
        off = at - at[0] - np.outer((at - at[0]) @ ab / (ab @ ab), ab)
        worst = max(worst, np.linalg.norm(off, axis=1).max())
    return worst


print("chord error over length, times n^2 / bend (code 0.42 for every bend and n)")
for slope in (0, 40, 75):
    lay = np.array([np.cos(np.radians(slope)), 0, np.sin(np.radians(slope))])
    for bend in (0.25, 0.5, 0.75, 1.0):
        p = curve(bend, lay)
        print("  lay %2d degrees above the skin, bend %.2f: %s" % (slope, bend, "  ".join("n %2d: %.4f (%.2f)" % (n, chord(p, n), chord(p, n) * n * n / bend) for n in (2, 3, 4, 6, 8, 12))))
