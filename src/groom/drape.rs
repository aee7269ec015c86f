//! The shaft of a card: traced along the lay over the skin, lifted, and stiffened towards its own line.

use super::{
    lay::tangent,
    skin::{SkinMesh, SurfacePoint},
};
use bevy::math::{Quat, Vec3};

/// Largest turn of the skin below one stiff feather that it follows, degrees; beyond it runs straight on. A soft one follows
/// twice as far.
const FOLLOW_CONVEX: f32 = 80.0;
/// The same where the skin rises against the feather (axilla, chin).
const FOLLOW_CONCAVE: f32 = 50.0;

/// What shapes one shaft; lengths in metres, angles in radians.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// Length.
    pub length: f32,
    /// Width.
    pub width: f32,
    /// Turn about the skin's normal away from the lay.
    pub yaw: f32,
    /// Turn about the shaft.
    pub roll: f32,
    /// Angle to the skin at the root.
    pub lift: f32,
    /// Bend of the free feather, tip towards the body.
    pub curl: f32,
    /// 0 drapes, 1 keeps its own line.
    pub stiffness: f32,
    /// Height of what already lies on the skin here; reached a little above the root.
    pub clearance: f32,
    /// Segments along.
    pub segments: usize,
}

/// A shaft in bind pose: `segments + 1` points at equal arc length from root to tip.
#[derive(Clone, Debug, Default)]
pub struct Shaft {
    /// Points, metres.
    pub points: Vec<Vec3>,
    /// Unit normal of the front face at each point.
    pub normals: Vec<Vec3>,
    /// The skin below each point; none past the end of the trace.
    pub below: Vec<SurfacePoint>,
    /// Height of each point over the skin, metres; infinite past the end of the trace.
    pub heights: Vec<f32>,
    /// Curvature of the skin across the shaft, 1/m; positive where the sides fall away.
    pub across: f32,
}

/// Height over the skin at share `x` of the length, in lengths, for a lift of slope 1: rises everywhere, so that of two like
/// feathers the one rooted further towards the head is the higher at every place they share. Slope 1 at the root, 0.35 at the tip.
pub fn rise(x: f32) -> f32 {
    0.35 * x + 0.65 * x * (1.0 - 0.5 * x)
}

/// The free feather: a circular arc that leaves the root in `along` and bends by `curl` against `normal`.
pub fn arc(along: Vec3, normal: Vec3, curl: f32, length: f32, x: f32) -> Vec3 {
    let angle = curl * x;
    let (sine, versine) = if curl.abs() < 1.0e-4 {
        (x, 0.5 * curl * x * x)
    } else {
        (angle.sin() / curl, (1.0 - angle.cos()) / curl)
    };
    (along * sine - normal * versine) * length
}

/// Traces one shaft from its root. Derived in docs/book/birds.md#drape.
pub fn drape(skin: &SkinMesh, lay: &[Vec3], root: SurfacePoint, shape: &Shape) -> Shaft {
    let segments = shape.segments.clamp(1, 64);
    let trace = trace(skin, lay, root, shape, segments);
    let (origin, normal) = (trace[0].position, trace[0].normal);
    let start = trace[0].along;
    let slope = shape.lift.sin().clamp(-0.5, 1.0);
    let free = (start * shape.lift.cos() + normal * shape.lift.sin()).normalize_or(start);
    let free_normal = (normal - free * normal.dot(free)).normalize_or(normal);
    let target: Vec<Vec3> = trace
        .iter()
        .enumerate()
        .map(|(i, step)| {
            let x = i as f32 / segments as f32;
            let settle = (x * 4.0).min(1.0);
            let base = shape.clearance * settle * settle * (3.0 - 2.0 * settle);
            let draped = step.position + step.normal * (base + shape.length * slope * rise(x));
            let own = origin + normal * base + arc(free, free_normal, shape.curl, shape.length, x);
            let mixed = draped.lerp(own, shape.stiffness.clamp(0.0, 1.0));
            // The line of a stiff feather may not cut into the skin nor sink below its own tail-ward neighbors.
            let floor = base + shape.length * slope.max(0.0) * 0.5 * rise(x);
            let height = (mixed - step.position).dot(step.normal);
            if step.on_skin && height < floor {
                mixed + step.normal * (floor - height)
            } else {
                mixed
            }
        })
        .collect();
    let points = even(&target, shape, normal);
    let normals = frames(&points, &trace, shape.roll);
    let heights = points
        .iter()
        .zip(&trace)
        .map(|(point, step)| match step.on_skin {
            true => (*point - step.position).dot(step.normal).max(0.0),
            false => f32::INFINITY,
        })
        .collect();
    let across = curvature_across(skin, &trace[segments / 2], shape.width);
    Shaft {
        points,
        normals,
        heights,
        below: trace.iter().map(|step| step.at).collect(),
        across,
    }
}

/// One step of the trace.
#[derive(Clone, Copy)]
struct Step {
    at: SurfacePoint,
    position: Vec3,
    normal: Vec3,
    along: Vec3,
    on_skin: bool,
}

fn trace(
    skin: &SkinMesh,
    lay: &[Vec3],
    root: SurfacePoint,
    shape: &Shape,
    segments: usize,
) -> Vec<Step> {
    let normal = skin.normal(root);
    let turned = |at: SurfacePoint, normal: Vec3| {
        let along = tangent(skin.interpolate(lay, at), normal)
            .unwrap_or_else(|| normal.any_orthonormal_vector());
        Quat::from_axis_angle(normal, shape.yaw) * along
    };
    let mut step = Step {
        at: root,
        position: skin.position(root),
        normal,
        along: turned(root, normal),
        on_skin: true,
    };
    let mut list = vec![step];
    let parts = 8_usize.div_ceil(segments);
    let stride = shape.length / (segments * parts) as f32;
    let (mut convex, mut concave) = (0.0, 0.0);
    let supple = 2.0 - shape.stiffness.clamp(0.0, 1.0);
    for _ in 0..segments {
        for _ in 0..parts {
            let target = step.position + step.along * stride;
            if !step.on_skin {
                step.position = target;
                continue;
            }
            let at = skin.walk(step.at.triangle, target);
            let position = skin.position(at);
            let normal = skin.normal(at);
            let bend = normal.dot(step.normal).clamp(-1.0, 1.0).acos().to_degrees();
            if (normal - step.normal).dot(step.along) < 0.0 {
                concave += bend
            } else {
                convex += bend
            }
            // Past an edge or a fold of the skin the feather goes straight on.
            if position.distance(target) > 0.6 * stride
                || convex > FOLLOW_CONVEX * supple
                || concave > FOLLOW_CONCAVE * supple
            {
                step.on_skin = false;
                step.position = target;
                continue;
            }
            let carried = tangent(step.along, normal).unwrap_or(step.along);
            let along = (carried + turned(at, normal))
                .try_normalize()
                .unwrap_or(carried);
            step = Step {
                at,
                position,
                normal,
                along: tangent(along, normal).unwrap_or(carried),
                on_skin: true,
            };
        }
        list.push(step);
    }
    list
}

/// Points at equal arc length that follow the target and bend no tighter than one width (soft) to 2.5 widths (stiff), nor back on
/// themselves.
fn even(target: &[Vec3], shape: &Shape, normal: Vec3) -> Vec<Vec3> {
    let segments = target.len() - 1;
    let stride = shape.length / segments as f32;
    let tightest = shape.width * (1.0 + 6.0 * shape.stiffness.clamp(0.0, 0.25));
    let most = (stride / tightest.max(f32::MIN_POSITIVE)).clamp(0.02, 0.7);
    let mut points = vec![target[0]];
    let mut before: Option<Vec3> = None;
    let mut position = target[0];
    for &next in &target[1..] {
        let fallback = before.unwrap_or_else(|| normal.any_orthonormal_vector());
        let mut along = (next - position).try_normalize().unwrap_or(fallback);
        if let Some(last) = before {
            let angle = last.angle_between(along);
            if angle > most && angle.is_finite() {
                let share = most / angle;
                along = last.lerp(along, share).try_normalize().unwrap_or(last);
            }
        }
        position += along * stride;
        points.push(position);
        before = Some(along);
    }
    points
}

/// Normals along the shaft: carried without twist from the root, pulled six tenths towards the skin's.
fn frames(points: &[Vec3], trace: &[Step], roll: f32) -> Vec<Vec3> {
    let mut normal = trace[0].normal;
    let last = points.len() - 1;
    (0..=last)
        .map(|i| {
            let along = points[(i + 1).min(last)] - points[i.saturating_sub(1)];
            let along = along.try_normalize().unwrap_or(trace[i].along);
            let wanted = normal.lerp(trace[i].normal, 0.6);
            normal = tangent(wanted, along)
                .or_else(|| tangent(normal, along))
                .unwrap_or_else(|| along.any_orthonormal_vector());
            Quat::from_axis_angle(along, roll) * normal
        })
        .collect()
}

fn curvature_across(skin: &SkinMesh, step: &Step, width: f32) -> f32 {
    if !step.on_skin {
        return 0.0;
    }
    let side = step.along.cross(step.normal);
    let reach = 0.5 * width;
    let normal_at =
        |sign: f32| skin.normal(skin.walk(step.at.triangle, step.position + side * (sign * reach)));
    let turn = (normal_at(1.0) - normal_at(-1.0)).dot(side);
    let limit = 1.0 / width.max(f32::MIN_POSITIVE);
    (turn / width.max(f32::MIN_POSITIVE)).clamp(-limit, limit)
}
