"""Explicit vanes as meshes: round tubes with the radii, periods and storeys of a preset, cut at the flanks of the barbs."""

from dataclasses import dataclass, field
import math

import mitsuba as mi
import numpy as np

FACETS = 64
# Where proximal barbules lie among the distal ones, in spacings: a vane has no fixed place, so means over these.
PHASES = (0.0, 0.25, 0.5, 0.75)
BARB, DISTAL, PROXIMAL = 0, 1, 2
PARTS = ("barb", "distal", "proximal")


class Fibre:
    """One kind of fibre; lengths in units of its radius. `inner`: radius of the medulla or of the mirror core; `depth`: scattering
    coefficient of the medulla times its radius; `lambert`: a diffuse surface without an inside."""

    def __init__(self, eta=1.55, inner=0.85, mirror=False, depth=2.0, anisotropy=0.4, lambert=False):
        self.eta, self.inner, self.mirror = eta, inner, mirror
        self.depth, self.anisotropy, self.lambert = depth, anisotropy, lambert


@dataclass(frozen=True)
class Vane:
    """Lengths in micrometres, angles in degrees."""

    name: str
    period: float
    barb_radius: float
    spacing: float
    barb_angle: float
    barbule_angle: float
    radii: tuple = (6.0, 5.5)
    fibre: Fibre = field(default_factory=Fibre)

    @property
    def root_step(self):
        return self.period / math.tan(math.radians(self.barb_angle))

    @property
    def lift(self):
        return 0.5 * (self.radii[0] + self.radii[1])


def tube(start, end, radius, cuts):
    """Vertices, normals, faces of a capped tube whose ends lie on the planes x = cuts[0] and x = cuts[1] (None: square)."""
    start, end = np.array(start, float), np.array(end, float)
    along = (end - start) / np.linalg.norm(end - start)
    up = np.array([0.0, 0.0, 1.0])
    side = np.cross(up, along)
    turn = 2 * np.pi * (np.arange(FACETS) + 0.5) / FACETS
    normal = np.outer(np.cos(turn), side) + np.outer(np.sin(turn), up)
    # Corners outside the circle by as much as the middles of the facets are inside.
    reach = radius * 2 / (1 + math.cos(math.pi / FACETS))
    ring = normal * reach
    rings = []
    for anchor, cut in zip((start, end), cuts):
        points = anchor + ring
        if cut is not None:
            points = points + np.outer((cut - points[:, 0]) / along[0], along)
        rings.append(points)
    vertices = np.concatenate(rings)
    normals = np.concatenate([normal, normal])
    i = np.arange(FACETS)
    j = (i + 1) % FACETS
    faces = [np.stack([i, j, j + FACETS], 1), np.stack([i, j + FACETS, i + FACETS], 1)]
    for end_index, ring_points in enumerate(rings):
        base = len(vertices)
        outward = -along if end_index == 0 else along
        if cuts[end_index] is not None:
            outward = np.array([math.copysign(1.0, outward[0]), 0.0, 0.0])
        vertices = np.concatenate([vertices, ring_points])
        normals = np.concatenate([normals, np.tile(outward, (FACETS, 1))])
        k = np.arange(1, FACETS - 1)
        fan = np.stack([np.zeros_like(k), k, k + 1], 1) + base
        faces.append(fan if end_index == 1 else fan[:, ::-1])
    faces = np.concatenate(faces)
    # Outward winding.
    a, b, c = (vertices[faces[:, n]] for n in range(3))
    flip = np.einsum("ij,ij->i", np.cross(b - a, c - a), normals[faces].sum(1)) < 0
    faces[flip] = faces[flip][:, ::-1]
    return vertices, normals, faces


class Body:
    """A merged mesh of tubes, and per triangle its part, per tube its axis."""

    def __init__(self, tubes):
        vertices, normals, faces, owner = [], [], [], []
        count = 0
        self.part, point, along, radius = [], [], [], []
        for part, start, end, r, cuts in tubes:
            v, n, f = tube(start, end, r, cuts)
            faces.append(f + count)
            owner.append(np.full(len(f), len(self.part)))
            count += len(v)
            vertices.append(v)
            normals.append(n)
            self.part.append(part)
            point.append(start)
            d = np.subtract(end, start)
            along.append(d / np.linalg.norm(d))
            radius.append(r)
        vertices, normals = np.concatenate(vertices), np.concatenate(normals)
        faces = np.concatenate(faces)
        mesh = mi.Mesh("fibres", len(vertices), len(faces), has_vertex_normals=True)
        params = mi.traverse(mesh)
        params["vertex_positions"] = vertices.astype(np.float32).ravel()
        params["vertex_normals"] = normals.astype(np.float32).ravel()
        params["faces"] = faces.astype(np.uint32).ravel()
        params.update()
        self.scene = mi.load_dict({"type": "scene", "fibres": mesh})
        self.owner = mi.UInt32(np.concatenate(owner).astype(np.uint32))
        self.tube_part = mi.UInt32(np.array(self.part, np.uint32))
        self.point = mi.Vector3f(np.array(point, np.float32).T)
        self.along = mi.Vector3f(np.array(along, np.float32).T)
        self.radius = mi.Float(np.array(radius, np.float32))


def vane_body(vane, phase=0.0, half=420.0):
    """The vane around the origin: x across the barbs, y along them, z out of the front."""
    sin, cos = math.sin(math.radians(vane.barbule_angle)), math.cos(math.radians(vane.barbule_angle))
    barbs = math.ceil(half / vane.period)
    tubes = []
    for k in range(-barbs, barbs + 1):
        x = k * vane.period
        tubes.append((BARB, (x, -half - 80.0, 0.0), (x, half + 80.0, 0.0), vane.barb_radius, (None, None)))
    long = vane.period / sin
    for k in range(-barbs, barbs):
        low = k * vane.period
        cuts = (low + vane.barb_radius, low + vane.period - vane.barb_radius)
        for part, owner, sign in ((DISTAL, k, 1.0), (PROXIMAL, k + 1, -1.0)):
            x = owner * vane.period
            first = owner * vane.root_step + (phase * vane.spacing if part == PROXIMAL else 0.0)
            z = sign * vane.lift
            n0 = math.ceil((-half - long - first) / vane.spacing)
            n1 = math.floor((half - first) / vane.spacing)
            for n in range(n0, n1 + 1):
                y = first + n * vane.spacing
                ends = [(x + sign * t * sin, y + t * cos, z) for t in (0.2 * long, 0.8 * long)]
                order = cuts if sign > 0 else cuts[::-1]
                tubes.append((part, ends[0], ends[1], vane.radii[part - 1], order))
    return Body(tubes)


def fibre_body(radius=1.0):
    """One long fibre along x."""
    return Body([(0, (-300.0 * radius, 0.0, 0.0), (300.0 * radius, 0.0, 0.0), radius, (None, None))])
