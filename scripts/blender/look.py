"""What the `bake` example has written, read back by Blender: counts of the USD file, and a picture by Cycles of the glTF file.

    python scripts/blender/look.py out/blender/baked [out/blender/bird.glb]

Reads `baked.usda` and `baked.glb`, with the bird below if it is named, and writes `baked_cycles.png`. Fails if anything is missing.
"""

import sys

import bpy
from mathutils import Vector


def read_usd(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.usd_import(filepath=path)
    curves = sum(len(o.data.curves) for o in bpy.data.objects if o.type == "CURVES")
    faces = sum(len(o.data.polygons) for o in bpy.data.objects if o.type == "MESH")
    print(f"{path}: {curves} curves, {faces} faces")
    if not curves or not faces:
        sys.exit(f"{path}: no curves or no cards came back")


def render(base, bird):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=base + ".glb")
    cards = [o for o in bpy.data.objects if o.type == "MESH" and len(o.data.polygons) > 100]
    if not cards:
        sys.exit(f"{base}.glb: no cards came back")
    graph = bpy.context.evaluated_depsgraph_get()
    places = [o.matrix_world @ Vector(c) for o in cards for c in o.evaluated_get(graph).bound_box]
    low = Vector([min(p[k] for p in places) for k in range(3)])
    high = Vector([max(p[k] for p in places) for k in range(3)])
    if bird:
        bpy.ops.import_scene.gltf(filepath=bird)
    middle, size = (low + high) / 2, (high - low).length
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    # The direction of the examples' `hero` shot: from the front, the left and above.
    camera.location = middle + Vector((1.2, -1.4, 0.45)).normalized() * 3.4 * size
    camera.rotation_euler = (middle - camera.location).to_track_quat("-Z", "Y").to_euler()
    camera.data.angle = 0.3
    camera.data.clip_start = size * 0.01
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy = 3.0
    sun.rotation_euler = Vector((-0.5, 0.6, -1.0)).to_track_quat("-Z", "Y").to_euler()
    world = bpy.data.worlds.new("Sky")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (0.5, 0.55, 0.6, 1)
    scene.world = world
    for thing in (camera, sun):
        scene.collection.objects.link(thing)
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = 24
    scene.cycles.transparent_max_bounces = 64
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = 960, 540
    scene.render.filepath = base + "_cycles.png"
    bpy.ops.render.render(write_still=True)
    print(f"wrote {scene.render.filepath}")


if __name__ == "__main__":
    read_usd(sys.argv[1] + ".usda")
    render(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else None)
