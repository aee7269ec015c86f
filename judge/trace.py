"""Light through explicit fibres: a wavefront over Mitsuba's ray casting, dielectric BSDF and phase function."""

import math

import drjit as dr
import mitsuba as mi
import numpy as np


@dr.syntax
def walk(body, fibre, position, direction, seed, lattice, most=160):
    """Follows rays until they escape. Returns escape direction, absorbing length (in radii of the fibre passed), core hits,
    fibres met, first tube, alive flag (True: never escaped), whether all fibres met were parallel."""
    n = dr.width(position)
    rng = mi.PCG32(n, seed)
    o, d = mi.Point3f(position), mi.Vector3f(direction)
    inside = dr.full(mi.Bool, False, n)
    tube = dr.zeros(mi.UInt32, n)
    first = dr.full(mi.UInt32, 0xFFFFFFFF, n)
    met = dr.zeros(mi.UInt32, n)
    parallel = dr.full(mi.Bool, True, n)
    length = dr.zeros(mi.Float, n)
    turns = dr.zeros(mi.UInt32, n)
    active = dr.full(mi.Bool, True, n)
    step = mi.UInt32(0)
    bsdf = mi.load_dict({"type": "dielectric", "int_ior": fibre.eta, "ext_ior": 1.0})
    phase = mi.load_dict({"type": "hg", "g": fibre.anisotropy})
    context = mi.BSDFContext(mi.TransportMode.Importance)
    while active & (step < most):
        step += 1
        # The vane repeats: a ray outside is brought back to its middle.
        if dr.hint(lattice is not None, mode="scalar"):
            period, root_step, spacing = lattice
            shift = dr.select(inside, 0.0, dr.round(o.x / period))
            down = shift * root_step
            rest = dr.select(inside, 0.0, dr.round((o.y - down) / spacing)) * spacing
            o = mi.Point3f(o.x - shift * period, o.y - down - rest, o.z)
        ray = mi.Ray3f(o, d)
        si = body.scene.ray_intersect(ray, active)
        active &= si.is_valid()
        u1, u2, u3 = rng.next_float32(), rng.next_float32(), rng.next_float32()
        # Within a fibre: its own axis; outside: that of the fibre met.
        hit = dr.select(inside, tube, dr.gather(mi.UInt32, body.owner, si.prim_index, active))
        r = dr.gather(mi.Float, body.radius, hit, active)
        axis = dr.gather(mi.Vector3f, body.along, hit, active)
        within = active & inside
        outer = active & ~inside
        off = mi.Vector3f(o) - dr.gather(mi.Vector3f, body.point, hit, active)
        oc = off - axis * dr.dot(off, axis)
        dc = d - axis * dr.dot(d, axis)
        a = dr.maximum(dr.squared_norm(dc), 1e-12)
        b = dr.dot(oc, dc)
        disc = b * b - a * (dr.squared_norm(oc) - dr.square(r * fibre.inner))
        root = dr.sqrt(dr.maximum(disc, 0.0))
        enter, leave = (-b - root) / a, (-b + root) / a
        way = mi.Float(si.t)
        if dr.hint(fibre.mirror, mode="scalar"):
            stays = within & (disc > 0) & (enter > 1e-4 * r) & (enter < si.t)
            way = dr.select(stays, enter, way)
            normal = dr.normalize(oc + dc * enter)
            turned = dr.normalize(d - 2.0 * dr.dot(d, normal) * normal)
        else:
            begin = dr.maximum(enter, 0.0)
            free = -dr.log(1.0 - u1) * (r * fibre.inner / max(fibre.depth, 1e-6))
            stays = within & (disc > 0) & (begin + free < dr.minimum(leave, si.t))
            way = dr.select(stays, begin + free, way)
            mei = dr.zeros(mi.MediumInteraction3f)
            mei.wi = -d
            mei.sh_frame = mi.Frame3f(-d)
            turned, _, _ = phase.sample(mi.PhaseFunctionContext(), mei, u2, mi.Point2f(u2, u3))
            turned = dr.normalize(turned)
        turns += dr.select(stays, 1, 0)
        length += dr.select(within, way / r, 0.0)
        first = dr.select(outer & (met == 0), hit, first)
        met += dr.select(outer, 1, 0)
        of_first = dr.gather(mi.UInt32, body.tube_part, first, outer)
        parallel &= ~outer | (dr.gather(mi.UInt32, body.tube_part, hit, outer) == of_first)
        tube = hit
        if dr.hint(fibre.lambert, mode="scalar"):
            facing = dr.select(dr.dot(si.n, d) < 0, 1.0, -1.0)
            world = mi.Frame3f(si.sh_frame.n * facing).to_world(mi.warp.square_to_cosine_hemisphere(mi.Point2f(u2, u3)))
            side = facing
        else:
            sample, _ = bsdf.sample(context, si, u2, mi.Point2f(u1, u3), active)
            world = dr.normalize(si.to_world(sample.wo))
            side = dr.select(dr.dot(world, si.n) > 0, 1.0, -1.0)
        wall = active & ~stays
        o = dr.select(active, dr.select(stays, o + d * way, si.p + si.n * (side * 1e-4 * r)), o)
        d = dr.select(active, dr.select(stays, turned, world), d)
        inside = dr.select(wall, side < 0, inside)
    return d, length, turns, met, first, active, parallel


def eye_rays(vane, eye, count, seed):
    """Parallel rays from the unit vector towards the eye onto one period of the vane."""
    rng = np.random.default_rng(seed)
    side = int(math.sqrt(count))
    i, j = np.meshgrid(np.arange(side), np.arange(side), indexing="ij")
    u = (i.ravel() + rng.random(side * side)) / side
    v = (j.ravel() + rng.random(side * side)) / side
    x = (u - 0.5) * vane.period
    y = (v - 0.5) * vane.spacing + u * vane.root_step
    top = 1.6 * max(vane.barb_radius, 2 * vane.radii[0])
    reach = top / abs(eye[2])
    o = np.stack([x + eye[0] * reach, y + eye[1] * reach, np.full_like(x, eye[2] * reach)])
    n = side * side
    return mi.Point3f(o.astype(np.float32)), mi.Vector3f(*(float(-c) for c in eye)) + dr.zeros(mi.Vector3f, n), n


def vane_paths(vane, body, eye, count, seed):
    o, d, n = eye_rays(vane, eye, count, seed)
    lattice = (vane.period, vane.root_step, vane.spacing)
    return paths(body, vane.fibre, o, d, seed, lattice)


def paths(body, fibre, o, d, seed, lattice):
    out, length, turns, met, first, lost, parallel = walk(body, fibre, o, d, seed, lattice)
    first = np.array(first)
    seen = first != 0xFFFFFFFF
    part = np.full(len(first), 3)
    part[seen] = np.array(body.part)[first[seen]]
    return {
        "direction": np.array(out).T.copy(),
        "length": np.array(length),
        "turns": np.array(turns),
        "met": np.array(met),
        "parallel": np.array(parallel),
        "part": part,
        "lost": np.array(lost),
        "count": len(first),
    }


def fibre_paths(body, fibre, theta, count, seed, azimuth=0.0):
    """One fibre along x of radius 1, the eye at inclination theta and azimuth from z towards y; over its whole width."""
    eye = np.array([math.sin(theta), math.cos(theta) * math.sin(azimuth), math.cos(theta) * math.cos(azimuth)])
    across = np.array([0.0, math.cos(azimuth), -math.sin(azimuth)])
    rng = np.random.default_rng(seed)
    h = (np.arange(count) + rng.random(count)) / count * 2 - 1
    h *= 1 - 1e-5
    o = np.outer(across, h) + (eye * 4.0 / max(math.cos(theta), 0.05))[:, None]
    d = mi.Vector3f(*(float(-c) for c in eye)) + dr.zeros(mi.Vector3f, count)
    return paths(body, fibre, mi.Point3f(o.astype(np.float32)), d, seed, None)
