#define_import_path bevy_plumage::down_walk

// The way of a ray through the prisms of the shell. Twin of src/maths/undercoat/walk.rs and src/maths/undercoat/shell, where the
// comments are.
//
// The module has no bindings. Its user fetches a prism and its six corners, and asks for one tetrahedron after the other:
//
//   var walk = walk_start(corners, face, origin, direction);      // face = start & 15u of the outside's triangle
//   for (var i = 0u; i < MAX_CELLS; i++) {
//       let exit = tet_exit(corners, parity, walk.tet, walk.face, origin, direction);
//       if exit.face == NO_FACE { break; }
//       let t = max(exit.t, walk.t);
//       let place = face_place(corners, exit.face, origin + t * direction);
//       ... march from (walk.t, walk.place) to (t, place) in this prism ...
//       if exit.face == FACE_SKIN { skin; break; }
//       if exit.face == FACE_TOP { air; break; }
//       if exit.face < FACE_TOP { walk = Walk(tet_across(exit.face, walk.tet), exit.face, t, place); continue; }
//       let link = links[(exit.face - 4u) % 3u];
//       if link == NO_LINK { air; break; }
//       fetch prism link / 4u, its corners and parity;
//       let face = linked_face(exit.face, link);
//       walk = Walk(face_tet(face), face, t, face_place(corners, face, origin + t * direction));
//   }

const MAX_CELLS: u32 = 256u;
const NO_FACE: u32 = 15u;
const NO_LINK: u32 = 0xffffffffu;
const FACE_SKIN: u32 = 0u;
const FACE_TOP: u32 = 3u;

// Bottom corners a, b, c (sorted by vertex) and their outer ends.
struct PrismCorners {
    a: vec3<f32>,
    b: vec3<f32>,
    c: vec3<f32>,
    a_top: vec3<f32>,
    b_top: vec3<f32>,
    c_top: vec3<f32>,
}

struct TetExit {
    t: f32,
    face: u32,
}

// Where a ray is inside the current prism. `place`: barycentric coordinates of a, b, c, and the height.
struct Walk {
    tet: u32,
    face: u32,
    t: f32,
    place: vec4<f32>,
}

struct FaceCorners {
    p: vec3<f32>,
    q: vec3<f32>,
    r: vec3<f32>,
}

// 1 or -1 from a prism's word `order`.
fn prism_parity(order: u32) -> f32 {
    return select(1.0, -1.0, (order & 64u) != 0u);
}

// Corner of the mesh's triangle that the sorted corner k is.
fn source_corner(order: u32, k: u32) -> u32 {
    return min((order >> (2u * min(k, 2u))) & 3u, 2u);
}

fn face_corners(p: PrismCorners, face: u32) -> FaceCorners {
    switch face {
        case 0u: { return FaceCorners(p.a, p.b, p.c); }
        case 1u: { return FaceCorners(p.a, p.b, p.c_top); }
        case 2u: { return FaceCorners(p.a, p.b_top, p.c_top); }
        case 4u: { return FaceCorners(p.a, p.b, p.b_top); }
        case 5u: { return FaceCorners(p.b, p.c, p.c_top); }
        case 6u: { return FaceCorners(p.a, p.c, p.c_top); }
        case 7u: { return FaceCorners(p.a, p.a_top, p.b_top); }
        case 8u: { return FaceCorners(p.b, p.b_top, p.c_top); }
        case 9u: { return FaceCorners(p.a, p.a_top, p.c_top); }
        default: { return FaceCorners(p.a_top, p.b_top, p.c_top); }
    }
}

// Height of the three corners of a face: 0 or 1 each.
fn face_heights(face: u32) -> vec3<f32> {
    switch face {
        case 0u: { return vec3(0.0, 0.0, 0.0); }
        case 1u, 4u, 5u, 6u: { return vec3(0.0, 0.0, 1.0); }
        case 3u: { return vec3(1.0, 1.0, 1.0); }
        default: { return vec3(0.0, 1.0, 1.0); }
    }
}

// Distance and side of a face's plane; both neighbors compute the same bits.
fn face_plane(f: FaceCorners, origin: vec3<f32>, direction: vec3<f32>) -> vec2<f32> {
    let n = cross(f.q - f.p, f.r - f.p);
    return vec2(dot(n, f.p - origin), dot(n, direction));
}

fn nearer(
    best: TetExit,
    f: FaceCorners,
    face: u32,
    sign: f32,
    entered: u32,
    origin: vec3<f32>,
    direction: vec3<f32>,
) -> TetExit {
    let plane = face_plane(f, origin, direction);
    if face == entered || plane.y * sign <= 0.0 {
        return best;
    }
    let t = plane.x / plane.y;
    if t < best.t {
        return TetExit(t, face);
    }
    return best;
}

fn tet_exit(p: PrismCorners, parity: f32, tet: u32, entered: u32, o: vec3<f32>, d: vec3<f32>) -> TetExit {
    var e = TetExit(3.0e38, NO_FACE);
    switch tet {
        case 0u: {
            e = nearer(e, FaceCorners(p.a, p.b, p.c), 0u, -parity, entered, o, d);
            e = nearer(e, FaceCorners(p.a, p.b, p.c_top), 1u, parity, entered, o, d);
            e = nearer(e, FaceCorners(p.a, p.c, p.c_top), 6u, -parity, entered, o, d);
            e = nearer(e, FaceCorners(p.b, p.c, p.c_top), 5u, parity, entered, o, d);
        }
        case 1u: {
            e = nearer(e, FaceCorners(p.a, p.b, p.b_top), 4u, parity, entered, o, d);
            e = nearer(e, FaceCorners(p.a, p.b, p.c_top), 1u, -parity, entered, o, d);
            e = nearer(e, FaceCorners(p.a, p.b_top, p.c_top), 2u, parity, entered, o, d);
            e = nearer(e, FaceCorners(p.b, p.b_top, p.c_top), 8u, -parity, entered, o, d);
        }
        default: {
            e = nearer(e, FaceCorners(p.a, p.a_top, p.b_top), 7u, -parity, entered, o, d);
            e = nearer(e, FaceCorners(p.a, p.a_top, p.c_top), 9u, parity, entered, o, d);
            e = nearer(e, FaceCorners(p.a, p.b_top, p.c_top), 2u, -parity, entered, o, d);
            e = nearer(e, FaceCorners(p.a_top, p.b_top, p.c_top), 3u, parity, entered, o, d);
        }
    }
    return e;
}

fn face_place(corners: PrismCorners, face: u32, point: vec3<f32>) -> vec4<f32> {
    let f = face_corners(corners, face);
    let u = f.q - f.p;
    let v = f.r - f.p;
    let w = point - f.p;
    let n = cross(u, v);
    let square = max(dot(n, n), 1e-36);
    let second = clamp(dot(cross(w, v), n) / square, 0.0, 1.0);
    let third = min(clamp(dot(cross(u, w), n) / square, 0.0, 1.0), 1.0 - second);
    let weights = vec3(1.0 - second - third, second, third);
    let height = min(dot(weights, face_heights(face)), 1.0);
    switch face {
        // Of a wall's half, two corners stand above each other.
        case 4u: { return vec4(weights.x, weights.y + weights.z, 0.0, height); }
        case 5u: { return vec4(0.0, weights.x, weights.y + weights.z, height); }
        case 6u: { return vec4(weights.x, 0.0, weights.y + weights.z, height); }
        case 7u: { return vec4(weights.x + weights.y, weights.z, 0.0, height); }
        case 8u: { return vec4(0.0, weights.x + weights.y, weights.z, height); }
        case 9u: { return vec4(weights.x + weights.y, 0.0, weights.z, height); }
        default: { return vec4(weights, height); }
    }
}

// Tetrahedron behind an outer face.
fn face_tet(face: u32) -> u32 {
    switch face {
        case 0u, 5u, 6u: { return 0u; }
        case 4u, 8u: { return 1u; }
        default: { return 2u; }
    }
}

fn tet_across(face: u32, tet: u32) -> u32 {
    if face == 1u {
        return select(0u, 1u, tet == 0u);
    }
    return select(2u, 1u, tet == 2u);
}

fn linked_face(face: u32, link: u32) -> u32 {
    return 4u + (link & 3u) + select(0u, 3u, face >= 7u);
}

// A ray that enters the prism through its outer face `face`.
fn walk_start(corners: PrismCorners, face: u32, origin: vec3<f32>, direction: vec3<f32>) -> Walk {
    let plane = face_plane(face_corners(corners, face), origin, direction);
    let t = select(max(plane.x / plane.y, 0.0), 0.0, plane.y == 0.0);
    return Walk(face_tet(face), face, t, face_place(corners, face, origin + t * direction));
}
