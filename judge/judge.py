"""Light of a vane by Mitsuba 3: paths through explicit fibres, written as one table that the crate is compared with.

    python judge.py OUTPUT.csv [--paths N] [--cache FOLDER]

Rows (angles in degrees; x runs across the barbs, y along them, z out of the front):
    fibre,KIND,THETA,COLOR,R,BESIDE,INSIDE
        energies of one fibre: surface reflection, light that met neither medulla nor core, the rest
    coverage,VANE,EYE x y z,BARB,DISTAL,PROXIMAL
    light,VANE,COLOR,EYE x y z,LIGHT x y z,K (barb mirror, even, distal, proximal),ONE,ONE_SD,ALL,ALL_SD
        light from a cone of 15 degrees; K: the share that one such fibre alone, seen over its whole width, sends there
    furnace,VANE,COLOR,EYE x y z,ONE,ALL
        shares of light from all around that come back from what is covered
COLOR is the absorption per fibre radius of a pigment fibre and the reflectance of a mirror core.
"""

import argparse
import csv
import math
import os

import numpy as np

CONE = math.radians(15.0)
PIGMENT_COLORS = (0.0, 0.2, 1.0)
MIRROR_COLORS = (1.0, 0.5)
# In the furnace alone: fibres of an albedo of about 0.8.
PIGMENT_FURNACE, MIRROR_FURNACE = (0.06,), (0.8,)


def direction(angle, axis, back=False):
    a = math.radians(angle)
    v = [0.0, 0.0, math.cos(a) * (-1.0 if back else 1.0)]
    v["xy".index(axis)] = math.sin(a)
    return v


EYES = {
    "n": direction(0, "x"),
    "60x": direction(60, "x"),
    "60y": direction(60, "y"),
    "b": direction(0, "x", True),
    "75x": direction(75, "x"),
    "45x": direction(45, "x"),
}
LIGHTS = {
    "n": direction(0, "x"),
    "45x": direction(45, "x"),
    "-45x": direction(-45, "x"),
    "45y": direction(45, "y"),
    "-45y": direction(-45, "y"),
    "75x": direction(75, "x"),
    "-75x": direction(-75, "x"),
    "75y": direction(75, "y"),
    "b": direction(0, "x", True),
    "b45x": direction(45, "x", True),
    "b-45x": direction(-45, "x", True),
    "b45y": direction(45, "y", True),
}


def vanes():
    """A macaw's lesser covert and blue remex, an eagle's dark contour feather, and the covert of Lambertian fibres."""
    from vane import Fibre, Vane

    pigment, mirror, lambert = Fibre(), Fibre(inner=0.7, mirror=True), Fibre(lambert=True)
    made = lambda name, pitch, angle, barb, spacing, barbule, fibre: Vane(
        name, pitch * math.sin(math.radians(angle)), barb, spacing, angle, barbule, (6.0, 5.5), fibre
    )
    return {
        "covert": made("covert", 380.0, 38.0, 14.0, 34.5, 37.5, pigment),
        "remex": made("remex", 450.0, 33.0, 30.0, 34.5, 40.0, mirror),
        "eagle": made("eagle", 550.0, 42.0, 17.5, 35.5, 37.5, pigment),
        "lambert": made("lambert", 380.0, 38.0, 14.0, 34.5, 37.5, lambert),
    }


def tangents(vane):
    a = math.radians(vane.barbule_angle)
    return [(0.0, 1.0, 0.0), (math.sin(a), math.cos(a), 0.0), (-math.sin(a), math.cos(a), 0.0)]


class Judge:
    def __init__(self, paths, cache):
        self.paths, self.cache = paths, cache
        self.made, self.found = {}, {}
        if cache:
            os.makedirs(cache, exist_ok=True)

    def kept(self, name, run):
        """The result of `run`, found once, and from the cache where it is there."""
        if name not in self.found:
            self.found[name] = self.cached(name, run)
        return self.found[name]

    def cached(self, name, run):
        file = self.cache and os.path.join(self.cache, name + ".npz")
        if file and os.path.exists(file):
            return dict(np.load(file))
        print(name, flush=True)
        result = run()
        if file:
            small = {k: v.astype(np.float32) if v.dtype.kind == "f" else v for k, v in result.items()}
            np.savez(file, **small)
        return result

    def bodies(self, vane):
        """The vane in each of its phases."""
        from vane import PHASES, vane_body

        if vane.name not in self.made:
            self.made[vane.name] = [vane_body(vane, phase) for phase in PHASES]
        return self.made[vane.name]

    def vane(self, vane, eye):
        def run():
            from trace import vane_paths

            share = self.paths // len(self.bodies(vane))
            found = [vane_paths(vane, body, EYES[eye], share, 7 + k) for k, body in enumerate(self.bodies(vane))]
            return {k: np.concatenate([one[k] for one in found]) for k in found[0] if k != "count"}

        return self.kept(f"{vane.name}_{eye}", run)

    def fibres(self, vane, eye):
        """Paths through each part's fibre alone, in the frame of the vane."""

        def run():
            from trace import fibre_paths
            from vane import fibre_body

            out = {}
            for part, tangent in enumerate(tangents(vane)):
                x = np.array(tangent)
                z = np.array([0.0, 0.0, 1.0])
                frame = np.stack([x, np.cross(z, x), z])
                local = frame @ np.array(EYES[eye])
                theta, azimuth = math.asin(local[0]), math.atan2(local[1], local[2])
                found = fibre_paths(fibre_body(), vane.fibre, theta, self.paths, 11, azimuth)
                out[f"d{part}"] = found["direction"] @ frame
                out[f"L{part}"] = found["length"]
                out[f"t{part}"] = np.minimum(found["turns"], 255).astype(np.uint8)
                out[f"ok{part}"] = (found["met"] > 0) & ~found["lost"].astype(bool)
            return out

        return self.kept(f"fibre_{vane.name}_{eye}", run)


def weight(fibre, color, length, turns):
    if fibre.lambert:
        return color ** np.ones_like(length)
    return np.power(color, turns) if fibre.mirror else np.exp(-color * length)


def furnace_rows(judge, vane):
    """Furnaces of the colors that have no lights."""
    for eye_name, eye in EYES.items():
        paths = judge.vane(vane, eye_name)
        covered = (paths["part"] < 3) & ~paths["lost"].astype(bool)
        length, turns = paths["length"].astype(float), paths["turns"].astype(float)
        for color in MIRROR_FURNACE if vane.fibre.mirror else PIGMENT_FURNACE:
            w = weight(vane.fibre, color, length, turns)
            share = lambda mask: (w * mask).sum() / covered.sum()
            yield ["furnace", vane.name, color, *eye, share(covered & (paths["met"] == 1)), share(covered)]


def light_rows(judge, vane):
    colors = MIRROR_COLORS if vane.fibre.mirror else PIGMENT_COLORS
    for eye_name, eye in EYES.items():
        paths, fibres = judge.vane(vane, eye_name), judge.fibres(vane, eye_name)
        length = paths["length"].astype(float)
        turns = paths["turns"].astype(float)
        covered = (paths["part"] < 3) & ~paths["lost"].astype(bool)
        one = covered & (paths["met"] == 1)
        for color in colors:
            w = weight(vane.fibre, color, length, turns)
            share = lambda mask: (w * mask).sum() / covered.sum()
            yield ["furnace", vane.name, color, *eye, share(one), share(covered)]
            again, later = share(covered & (paths["met"] > 1)), share(covered & (paths["met"] > 2))
            alone = share(covered & (paths["met"] > 1) & paths["parallel"].astype(bool))
            print(
                f"{vane.name} {color} {eye_name}: {again:.3f} met several fibres, {later / again:.3f} of it more than two,"
                f" {alone / again:.3f} parallel ones alone",
                flush=True,
            )
            for light_name, light in LIGHTS.items():
                inside = paths["direction"] @ np.array(light) > math.cos(CONE)
                row = []
                for part in range(3):
                    ok = fibres[f"ok{part}"].astype(bool)
                    l, t = fibres[f"L{part}"].astype(float), fibres[f"t{part}"].astype(float)
                    there = (fibres[f"d{part}"] @ np.array(light) > math.cos(CONE)) & ok
                    k = weight(vane.fibre, color, l, t) * there / ok.sum()
                    mirror = (l == 0) | ((t > 0) & vane.fibre.mirror)
                    row += [k[mirror].sum(), k[~mirror].sum()]
                for mask in (one, covered):
                    x = w * (inside & mask)
                    row += [x.sum() / len(x), math.sqrt((x * x).sum()) / len(x)]
                yield ["light", vane.name, color, *eye, *light, *row]


def fibre_rows(judge):
    from vane import Fibre, fibre_body

    for kind, fibre, colors in (
        ("pigment", Fibre(), PIGMENT_COLORS),
        ("structural", Fibre(inner=0.7, mirror=True), MIRROR_COLORS),
    ):
        for theta in (0.0, 30.0, 60.0, 75.0):

            def run():
                from trace import fibre_paths

                found = fibre_paths(fibre_body(), fibre, math.radians(theta), judge.paths, 3)
                return {k: v for k, v in found.items() if k != "count"}

            found = judge.kept(f"alone_{kind}_{theta:.0f}", run)
            ok = found["met"] > 0
            length, turns = found["length"].astype(float), found["turns"].astype(float)
            for color in colors:
                w = weight(fibre, color, length, turns)
                parts = (ok & (length == 0), ok & (length > 0) & (turns == 0), ok & (turns > 0))
                yield ["fibre", kind, theta, color, *((w * p).sum() / ok.sum() for p in parts)]


def coverage_rows(judge, vane):
    """First hits alone."""
    from trace import eye_rays

    import mitsuba as mi

    for axis in "xy":
        for angle in (0, 15, 30, 45, 60, 75, 80):
            for back in (False, True):
                if angle == 0 and axis == "y":
                    continue
                eye = direction(angle, axis, back)
                shares = []
                for seed, body in enumerate(judge.bodies(vane)):
                    o, d, n = eye_rays(vane, eye, 62500, 5 + seed)
                    hit = body.scene.ray_intersect_preliminary(mi.Ray3f(o, d), coherent=False)
                    valid, prim = np.array(hit.is_valid()), np.array(hit.prim_index)
                    part = np.full(n, 3)
                    part[valid] = np.array(body.part)[np.array(body.owner)[prim[valid]]]
                    shares.append([(part == k).mean() for k in range(3)])
                yield ["coverage", vane.name, *eye, *np.mean(shares, axis=0)]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("output")
    parser.add_argument("--paths", type=int, default=360000)
    parser.add_argument("--cache")
    arguments = parser.parse_args()

    import mitsuba as mi

    mi.set_variant("llvm_ad_mono")
    judge = Judge(arguments.paths, arguments.cache)
    rows = list(fibre_rows(judge))
    for vane in vanes().values():
        if not vane.fibre.lambert:
            rows += coverage_rows(judge, vane)
            rows += light_rows(judge, vane)
            rows += furnace_rows(judge, vane)
    with open(arguments.output, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        for row in rows:
            writer.writerow([f"{x:.5g}" if isinstance(x, float) else x for x in row])


if __name__ == "__main__":
    main()
