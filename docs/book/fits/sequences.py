"""Low-discrepancy sequences: the roots of x^(d+1) = x + 1 (generalised golden ratios) and where their powers stand in the code."""
import numpy as np
from scipy.optimize import brentq

for d in (1, 2, 4):
    g = brentq(lambda x: x ** (d + 1) - x - 1, 1, 2)
    print("d = %d: g = %.9f, powers -1..-%d: %s" % (d, g, d, " ".join("%.8f" % g**-k for k in range(1, d + 1))))
print("code: feather_environment 0.85667488 0.73389185 0.62870671 (d = 4); march_jitter and tiles 0.618033988749895 (d = 1);")
print("      azimuths of the tier tables 0.754877666246693 (d = 2)")
