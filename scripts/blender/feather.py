"""From an untouched bird to one that grows feathers as its artist wants them: the steps of docs/blender.md.

    python scripts/blender/feather.py out/blender/bird.glb

The bird is a plain mesh with materials and three bones. Feathers need nothing of what is added to it here; each addition is a wish.
"""

import math
import pathlib
import sys

import bpy
from mathutils import Vector


def untouched():
    """Step 1, the bird as it was: head towards -y, z up, metres. Body, head, bill and tail as one skin on three bones."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    balls = bpy.data.metaballs.new("Bird")
    balls.resolution = 0.008
    balls.threshold = 0.1

    def ball(place, size):
        element = balls.elements.new(type="ELLIPSOID")
        element.co = place
        element.radius = 0.1
        element.size_x, element.size_y, element.size_z = size

    ball((0, 0, 0), (0.62, 1.1, 0.58))
    ball((0, -0.11, 0.06), (0.42, 0.42, 0.42))
    ball((0, -0.165, 0.055), (0.14, 0.34, 0.12))
    ball((0, 0.12, -0.005), (0.45, 0.6, 0.14))
    for side in (1, -1):
        ball((side * 0.13, 0.01, 0.02), (1.0, 0.5, 0.12))
    blob = bpy.data.objects.new("Blob", balls)
    bpy.context.collection.objects.link(blob)
    graph = bpy.context.evaluated_depsgraph_get()
    mesh = bpy.data.meshes.new_from_object(blob.evaluated_get(graph))
    bpy.data.objects.remove(blob)
    for polygon in mesh.polygons:
        polygon.use_smooth = True
    for name, color in (("brown", (0.25, 0.13, 0.06, 1)), ("cream", (0.75, 0.62, 0.42, 1))):
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = color
        mesh.materials.append(material)
    for polygon in mesh.polygons:
        polygon.material_index = 1 if polygon.normal.z < -0.2 else 0
    skin = bpy.data.objects.new("Bird", mesh)
    bpy.context.collection.objects.link(skin)
    bones = {"body": (0, 0.06), "head": (-0.08, -0.16), "tail": (0.08, 0.2)}
    frame = bpy.data.objects.new("Skeleton", bpy.data.armatures.new("Skeleton"))
    bpy.context.collection.objects.link(frame)
    bpy.context.view_layer.objects.active = frame
    bpy.ops.object.mode_set(mode="EDIT")
    for name, (head, tail) in bones.items():
        bone = frame.data.edit_bones.new(name)
        bone.head, bone.tail = (0, head, 0), (0, tail, 0)
        if name != "body":
            bone.parent = frame.data.edit_bones["body"]
    bpy.ops.object.mode_set(mode="OBJECT")
    skin.parent = frame
    skin.modifiers.new("Skeleton", "ARMATURE").object = frame
    groups = {name: skin.vertex_groups.new(name=name) for name in bones}
    for vertex in mesh.vertices:
        y = vertex.co.y
        head = min(max((-y - 0.05) / 0.06, 0), 1)
        tail = min(max((y - 0.06) / 0.06, 0), 1)
        for name, weight in (("head", head), ("tail", tail), ("body", 1 - head - tail)):
            if weight > 0:
                groups[name].add([vertex.index], weight, "REPLACE")
    return skin


def paint(skin, name, value):
    """Steps 3 and 4: a number at every vertex, as vertex paint or geometry nodes would leave it."""
    attribute = skin.data.attributes.new(name, "FLOAT", "POINT")
    attribute.data.foreach_set("value", [value(vertex.co) for vertex in skin.data.vertices])


def guides(skin, curves):
    """Step 5: curves along the lay, root to tip, as a mesh of loose edges; they need not touch the skin."""
    points, edges = [], []
    for curve in curves:
        first = len(points)
        points += curve
        edges += [(i, i + 1) for i in range(first, len(points) - 1)]
    mesh = bpy.data.meshes.new("guides")
    mesh.from_pydata(points, edges, [])
    drawn = bpy.data.objects.new("guides", mesh)
    drawn["mirror"] = True
    drawn.parent = skin.parent
    bpy.context.collection.objects.link(drawn)


def empty(skin, name, place, turn, **extras):
    """Step 6: an empty with custom properties; its z axis is the shaft, its -y axis the normal of the front face."""
    node = bpy.data.objects.new(name, None)
    node.empty_display_type = "SINGLE_ARROW"
    node.location, node.rotation_euler = place, turn
    node.parent = skin.parent
    for key, value in extras.items():
        node[key] = value
    bpy.context.collection.objects.link(node)


def main(path):
    skin = untouched()
    # Step 2: sizes in metres, transforms applied; here they are.
    bill = Vector((0, -0.19, 0.055))
    paint(skin, "_density", lambda p: 0.0 if (p - bill).length < 0.03 else 1.0)
    paint(skin, "_length", lambda p: 0.45 if p.y < -0.08 else 1.0)
    guides(
        skin,
        [
            [(0, -0.15, 0.09), (0, -0.05, 0.09), (0, 0.06, 0.06), (0, 0.16, 0.02)],
            [(0, -0.12, 0.0), (0, 0.0, -0.06), (0, 0.1, -0.04), (0, 0.16, -0.02)],
            [(0.05, -0.11, 0.06), (0.06, -0.02, 0.03), (0.05, 0.08, 0.02)],
            [(0.09, -0.02, 0.035), (0.13, 0.03, 0.03), (0.15, 0.06, 0.025)],
            [(0.16, -0.01, 0.03), (0.2, 0.02, 0.025), (0.22, 0.05, 0.02)],
            [(0.09, -0.02, 0.0), (0.13, 0.03, 0.0), (0.15, 0.06, 0.0)],
        ],
    )
    back = -math.pi / 2
    lengths = [0.16, 0.165, 0.17, 0.172, 0.17, 0.165]
    empty(skin, "row.tail", (0, 0.14, 0), (0, 0, 0), lengths=lengths, width=[0.035, 0.03], mirror=True)
    empty(skin, "row.tail.001", (0.004, 0.14, 0.005), (back, 0, -0.02), at=0.0, ride="tail")
    empty(skin, "row.tail.002", (0.045, 0.13, 0.0), (back, 0, -0.5), at=1.0, ride="tail")
    pathlib.Path(path).parent.mkdir(parents=True, exist_ok=True)
    # Step 7: what is not ticked by default in the exporter's panel.
    bpy.ops.export_scene.gltf(
        filepath=str(path),
        export_format="GLB",
        export_attributes=True,
        use_mesh_edges=True,
        export_extras=True,
    )
    print(f"wrote {path}: {len(skin.data.vertices)} vertices")


if __name__ == "__main__":
    main(sys.argv[1])
