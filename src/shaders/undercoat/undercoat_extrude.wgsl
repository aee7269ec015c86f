// One thread per node of a shell: skins it and raises its top (src/undercoat/extrude.rs).

struct ExtrudeParams {
    world_from_local: mat4x4<f32>,
    node_count: u32,
    skin_index: u32,
    padding_a: u32,
    padding_b: u32,
}

const NO_SKIN: u32 = 0xffffffffu;
// Vec4s of a node, extruded and at rest (src/undercoat/pack.rs).
const NODE_VEC4S: u32 = 3u;
const REST_VEC4S: u32 = 4u;

@group(0) @binding(0) var<uniform> params: ExtrudeParams;
@group(0) @binding(1) var<storage, read> rest: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read_write> nodes: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> joints: array<mat4x4<f32>>;

fn joint(index: u32) -> mat4x4<f32> {
    return joints[min(params.skin_index + index, arrayLength(&joints) - 1u)];
}

fn unit_or(v: vec3<f32>, other: vec3<f32>) -> vec3<f32> {
    let length = length(v);
    return select(other, v / length, length > 1e-12);
}

@compute @workgroup_size(64)
fn extrude(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.node_count || REST_VEC4S * (id.x + 1u) > arrayLength(&rest)
        || NODE_VEC4S * (id.x + 1u) > arrayLength(&nodes)) {
        return;
    }
    let place = bitcast<vec4<f32>>(rest[REST_VEC4S * id.x]);
    let rest_normal = bitcast<vec3<f32>>(rest[REST_VEC4S * id.x + 1u].xyz);
    let lay = rest[REST_VEC4S * id.x + 2u];
    let carried = rest[REST_VEC4S * id.x + 3u];
    let weights = vec4(unpack2x16unorm(carried.z), unpack2x16unorm(carried.w));
    var world = params.world_from_local;
    let total = weights.x + weights.y + weights.z + weights.w;
    if (params.skin_index != NO_SKIN && total > 0.0) {
        let w = weights / total;
        world = joint(carried.x & 0xffffu) * w.x + joint(carried.x >> 16u) * w.y
            + joint(carried.y & 0xffffu) * w.z + joint(carried.y >> 16u) * w.w;
    }
    let linear = mat3x3(world[0].xyz, world[1].xyz, world[2].xyz);
    // Normals turn with the cofactors; no division by a determinant that may vanish.
    let cofactors = mat3x3(
        cross(linear[1], linear[2]),
        cross(linear[2], linear[0]),
        cross(linear[0], linear[1]),
    );
    let side = select(1.0, -1.0, dot(linear[0], cofactors[0]) < 0.0);
    let normal = unit_or(side * (cofactors * rest_normal), vec3(0.0, 1.0, 0.0));
    let bottom = (world * vec4(place.xyz, 1.0)).xyz;
    let along = unit_or(linear * bitcast<vec3<f32>>(lay.xyz), normal);
    let at = NODE_VEC4S * id.x;
    nodes[at] = bitcast<vec4<u32>>(vec4(bottom, place.w));
    nodes[at + 1u] = bitcast<vec4<u32>>(vec4(bottom + normal * place.w, 0.0));
    nodes[at + 2u] = vec4(bitcast<vec3<u32>>(along), lay.w);
}
