"""Amounts of wind and ruffle (wind.md): the laws of `wind_response` and `wind_lift` through their anchor points."""
import numpy as np


def limit(s):
    return 1.5 + 12.5 * (1 - s) ** 2


print("largest tip angle 1.5 + 12.5 (1 - s)^2: s = 0 %.1f degrees (14), s = 1 %.1f (1.5)" % (limit(0), limit(1)))
print("  8 degrees, a contour feather's, at s = 1 - sqrt(6.5/12.5) = %.3f; grooms give contour feathers 0.25 to 0.3: %.1f to %.1f"
      % (1 - np.sqrt(6.5 / 12.5), limit(0.25), limit(0.3)))


def lift(s, length, speed):
    """Degrees, wind straight against the lay."""
    drive = np.sqrt(length) * speed**2 / max(s, 0.1)
    return limit(s) * drive / (limit(s) + drive)


print("tip angle in degrees, wind against the lay: compliance 1 degree s^2 m^-2.5 / stiffness")
print("   stiffness, length     1.2 m/s   3 m/s   10 m/s")
for name, s, length in (("soft 0.1, 40 mm", 0.1, 0.04), ("contour 0.28, 40 mm", 0.28, 0.04), ("covert 0.5, 80 mm", 0.5, 0.08), ("flight 1, 300 mm", 1.0, 0.3)):
    print("   %-20s  %6.2f   %6.2f   %6.2f" % (name, *(lift(s, length, v) for v in (1.2, 3, 10))))
print("with the compliance halved and doubled, contour feather at 3 m/s: %.2f, %.2f degrees"
      % tuple(limit(0.28) * d / (limit(0.28) + d) for d in (0.5 * 0.2 * 9 / 0.28, 2 * 0.2 * 9 / 0.28)))
print("ruffle: yaw of 6 degrees at a lift of 45 is %.2f degrees at one of 14 (wanted: 2)" % (6 * 14 / 45))
