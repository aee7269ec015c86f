//! The way of a ray through the shell: from tetrahedron to tetrahedron, each left through the nearest of its planes.
//!
//! Both cells at a face compute its distance with the same operations in the same order, so that a ray can slip through no
//! crack. Inside a tetrahedron the place in the prism (barycentric coordinates of the triangle and height, 0 on the skin and 1 at
//! the top) is an affine function of the distance; it is found at the faces, and the march interpolates
//! (docs/book/undercoat.md#shell). Keep coordinates relative to the mesh, and let the ray start near the shell, best at the
//! fragment's own place. Twin: `down_walk.wgsl`.

use super::shell::{FACE_CORNERS, NO_LINK, Shell, TET_FACES, WALL_TETS};
use crate::maths::{
    Real,
    vector::{add, cross, dot, scale, sub},
};

/// Most tetrahedra that a ray visits.
pub const MAX_CELLS: u32 = 256;

/// Code of a face that no ray came through.
pub const NO_FACE: u32 = 15;

/// Where a ray leaves a tetrahedron.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TetExit<T> {
    /// Distance along the ray, in lengths of its direction.
    pub t: T,
    /// Code of the face, or [`NO_FACE`] where the tetrahedron has no volume to leave.
    pub face: u32,
}

/// Distance to the plane of a face, and the cosine-like product that tells the side; both neighbors call it alike.
fn plane<T: Real>(corners: &[[T; 3]; 6], face: u32, origin: [T; 3], direction: [T; 3]) -> (T, T) {
    let [p, q, r] = FACE_CORNERS[face as usize % 10].map(|k| corners[k as usize]);
    let n = cross(sub(q, p), sub(r, p));
    (dot(n, sub(p, origin)), dot(n, direction))
}

/// Where a ray leaves tetrahedron `tet` (0..3) of a prism that it entered through the face `entered`.
pub fn tet_exit<T: Real>(
    corners: &[[T; 3]; 6],
    parity: T,
    tet: u32,
    entered: u32,
    origin: [T; 3],
    direction: [T; 3],
) -> TetExit<T> {
    let mut best = TetExit {
        t: T::of(f64::from(f32::MAX)),
        face: NO_FACE,
    };
    for (face, sign) in TET_FACES[tet.min(2) as usize] {
        let (distance, towards) = plane(corners, face, origin, direction);
        let out = towards * parity * T::of(f64::from(sign));
        if face != entered && out > T::zero() {
            let t = distance / towards;
            if t < best.t {
                best = TetExit { t, face };
            }
        }
    }
    best
}

/// Place of a point on a face: barycentric coordinates of the sorted corners a, b, c, and the height.
pub fn face_place<T: Real>(corners: &[[T; 3]; 6], face: u32, point: [T; 3]) -> [T; 4] {
    let vertices = FACE_CORNERS[face as usize % 10];
    let [p, q, r] = vertices.map(|k| corners[k as usize]);
    let (u, v, w) = (sub(q, p), sub(r, p), sub(point, p));
    let n = cross(u, v);
    let square = dot(n, n).max(T::of(1e-36));
    let unit = |x: T| x.max(T::zero()).min(T::one());
    let second = unit(dot(cross(w, v), n) / square);
    let third = unit(dot(cross(u, w), n) / square).min(T::one() - second);
    let weights = [T::one() - second - third, second, third];
    let mut place = [T::zero(); 4];
    for (k, weight) in vertices.into_iter().zip(weights) {
        place[k as usize % 3] = place[k as usize % 3] + weight;
        if k >= 3 {
            place[3] = (place[3] + weight).min(T::one());
        }
    }
    place
}

/// Tetrahedron of a prism behind its outer face `face` (3: top, 4..10: walls; 0: the skin, for rays that come out of it).
pub fn face_tet(face: u32) -> u32 {
    match face {
        0 => 0,
        4..=9 => WALL_TETS[face as usize - 4],
        _ => 2,
    }
}

/// A step of the walk: where a ray is inside the shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walk<T> {
    /// Prism.
    pub prism: u32,
    /// Tetrahedron of it.
    pub tet: u32,
    /// Face that the ray came through.
    pub face: u32,
    /// Distance along the ray.
    pub t: T,
    /// Place in the prism: barycentric coordinates of the sorted corners and height.
    pub place: [T; 4],
}

/// The ray's way through one tetrahedron.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment<T> {
    /// Prism.
    pub prism: u32,
    /// Distances along the ray.
    pub t: [T; 2],
    /// Places in the prism at both.
    pub place: [[T; 4]; 2],
}

/// How a walk ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WalkEnd {
    /// On the skin.
    Skin,
    /// In the air, through the top or a wall.
    Air,
    /// The visitor had enough.
    Stopped,
    /// [`MAX_CELLS`] visited.
    Limit,
    /// In a cell without volume.
    Lost,
}

/// A ray that enters through a face of the outside (`start` of [`ShellFace`](super::shell::ShellFace)).
pub fn walk_start<T: Real>(
    shell: &Shell,
    start: u32,
    origin: [T; 3],
    direction: [T; 3],
) -> Walk<T> {
    let (prism, face) = (start / 16, start % 16);
    let corners = shell.corners(prism as usize);
    let (distance, towards) = plane(&corners, face, origin, direction);
    let t = if towards == T::zero() {
        T::zero()
    } else {
        (distance / towards).max(T::zero())
    };
    let place = face_place(&corners, face, add(origin, scale(direction, t)));
    Walk {
        prism,
        tet: face_tet(face),
        face,
        t,
        place,
    }
}

/// Through one tetrahedron: the segment, and where the walk goes on or how it ended.
pub fn walk_step<T: Real>(
    shell: &Shell,
    walk: &Walk<T>,
    origin: [T; 3],
    direction: [T; 3],
) -> (Segment<T>, Result<Walk<T>, WalkEnd>) {
    let prism = &shell.prisms[walk.prism as usize];
    let corners = shell.corners(walk.prism as usize);
    let exit = tet_exit(
        &corners,
        prism.parity(),
        walk.tet,
        walk.face,
        origin,
        direction,
    );
    let mut segment = Segment {
        prism: walk.prism,
        t: [walk.t; 2],
        place: [walk.place; 2],
    };
    if exit.face == NO_FACE {
        return (segment, Err(WalkEnd::Lost));
    }
    let t = exit.t.max(walk.t);
    let place = face_place(&corners, exit.face, add(origin, scale(direction, t)));
    segment.t[1] = t;
    segment.place[1] = place;
    let next = match exit.face {
        0 => Err(WalkEnd::Skin),
        1 | 2 => Ok(Walk {
            tet: tet_across(exit.face, walk.tet),
            face: exit.face,
            t,
            place,
            ..*walk
        }),
        3 => Err(WalkEnd::Air),
        wall => match prism.links[(wall as usize - 4) % 3] {
            NO_LINK => Err(WalkEnd::Air),
            link => {
                let face = linked_face(wall, link);
                let near = shell.corners(link as usize / 4);
                Ok(Walk {
                    prism: link / 4,
                    tet: face_tet(face),
                    face,
                    t,
                    place: face_place(&near, face, add(origin, scale(direction, t))),
                })
            }
        },
    };
    (segment, next)
}

/// The other tetrahedron at an inner face (1 or 2).
pub fn tet_across(face: u32, tet: u32) -> u32 {
    match (face, tet) {
        (1, 0) | (2, 2) => 1,
        (1, _) => 0,
        _ => 2,
    }
}

/// Code that the neighbor gives to a wall's half, from the code here and the link.
pub fn linked_face(face: u32, link: u32) -> u32 {
    4 + (link & 3) + if face >= 7 { 3 } else { 0 }
}

/// Walks to the end; `visit` sees every segment and returns whether to go on.
pub fn walk<T: Real>(
    shell: &Shell,
    start: Walk<T>,
    origin: [T; 3],
    direction: [T; 3],
    mut visit: impl FnMut(&Segment<T>) -> bool,
) -> WalkEnd {
    let mut walk = start;
    for _ in 0..MAX_CELLS {
        let (segment, next) = walk_step(shell, &walk, origin, direction);
        if !visit(&segment) {
            return WalkEnd::Stopped;
        }
        match next {
            Ok(next) => walk = next,
            Err(end) => return end,
        }
    }
    WalkEnd::Limit
}
