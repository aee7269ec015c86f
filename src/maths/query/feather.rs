//! Coverage of a footprint by a whole feather as a card shows it: what is drawn. Twin of `query_feather.wgsl`.
//!
//! A shader has no closures, so it looks the outline up where its table is bound: its [`Outline`] is made in
//! `feather_cover.wgsl`, which calls the functions below in the order of [`cover`].

use super::{
    choose::{ErrorBudget, Lod},
    coverage::{Coverage, vane_coverage},
    masking::{mask_rachis, mask_vane, storeys, vane_shape, vane_stop},
    split::{
        averages, line_parts, line_share, outline_line, outline_share, rachis_line, rachis_share,
        split_line,
    },
    vane::{Vane, reduce},
};
use crate::maths::{
    card::{barb_cotangent, barb_root, barbule_factor, hooked, vane_start_coverage},
    footprint::{Footprint, LEAST_VARIANCE},
    functions::{Real, clamp},
};

/// A vane that shows less of a footprint than this is left out.
const LEAST_SHARE: f64 = 1e-3;
/// A part of a footprint with less mass than this is left out.
const LEAST_PART: f64 = 5e-4;

/// One vane as a card has it; lengths in feather lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CardVane<T> {
    /// Its pattern where the barbules hook.
    pub vane: Vane<T>,
    /// Share of a barb, from its end, where they do not, see [`hooked`].
    pub fringe: T,
    /// Height below which they do not.
    pub downy: T,
}

impl<T: Real> From<Vane<T>> for CardVane<T> {
    /// Hooked everywhere.
    fn from(vane: Vane<T>) -> Self {
        Self {
            vane,
            fringe: T::zero(),
            downy: T::zero(),
        }
    }
}

/// Least that one of two lines leaves of a footprint that both may cut into parts.
const LINE_SHARE: f64 = 0.98;

/// Where a vane ends, as a footprint sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outline<T> {
    /// How far the barb through the footprint's mean reaches along x, and its derivative by the root of the barb.
    pub reach: [T; 2],
    /// Share inside of what of the footprint lies on the vane's side of the shaft, see [`outline_share`].
    pub share: T,
}

/// What [`cover`] asks of a feather.
#[derive(Clone, Copy, Debug)]
pub struct CardFeather<T, F> {
    /// Left and right.
    pub vanes: [CardVane<T>; 2],
    /// Radius of the rachis at the footprint.
    pub rachis_radius: T,
    /// Root of the lowest barb.
    pub start: T,
    /// How far a barb reaches, and the derivative: by side (0 is the left) and root.
    pub reach: F,
    /// Distance of the roots for which the reach is stored, see [`outline_share`].
    pub spacing: T,
}

/// Whether a footprint over the left vane shows enough of it beside the rachis, whose edge is at `x = edge`.
pub fn shows_vane<T: Real>(footprint: &Footprint<T>, edge: T) -> bool {
    line_share(&rachis_line(edge), footprint) >= T::of(LEAST_SHARE)
}

/// One vane's share of a footprint (over the left vane, or mirrored there) beside the rachis, whose edge is at `x = edge`:
/// barbs, distal and proximal barbules, and the share of their width that the barbules show.
///
/// `view`: towards the eye, in the same frame. `lod` is what is known of the whole footprint, `parts_lod` of what a line leaves
/// of it.
pub fn cover_vane<T: Real>(
    card: &CardVane<T>,
    start: T,
    outline: &Outline<T>,
    footprint: &Footprint<T>,
    edge: T,
    view: [T; 3],
    lod: Lod,
    parts_lod: Lod,
    budget: &ErrorBudget<T>,
) -> [T; 4] {
    let (zero, one) = (T::zero(), T::one());
    let nothing = [zero, zero, zero, one];
    let rachis = rachis_line(edge);
    let beside = line_share(&rachis, footprint);
    if beside < T::of(LEAST_SHARE) {
        return nothing;
    }
    let mut vane = card.vane;
    let cotangent = barb_cotangent(vane.sin_b, vane.cos_b);
    let beyond = Footprint {
        mean: [footprint.mean[0].min(T::of(-1e-6)), footprint.mean[1]],
        ..*footprint
    };
    let begun = vane_start_coverage(&beyond, start, cotangent);
    if outline.share * begun < T::of(LEAST_SHARE) {
        return nothing;
    }
    // Loose barbules stand on edge: they are narrower, and hide less of each other.
    let [x, y] = footprint.mean;
    let hook = barbule_factor(hooked(
        x.abs(),
        y,
        outline.reach[0],
        card.fringe,
        card.downy,
    ));
    vane.hooked = hook;
    let cell = mask_vane(&vane, view);
    // Whichever of rachis and outline takes more of the footprint cuts it into parts, the other one scales them. Where the tangent
    // tells too little of the outline, the outline scales the whole.
    let end = outline_line(footprint.mean, outline.reach, cotangent);
    let straight = line_share(&end, footprint);
    let scale = outline.share / straight.max(T::of(1e-6));
    let is_line =
        scale <= T::of(2.0) && scale >= T::of(0.5) && straight.max(beside) > T::of(LINE_SHARE);
    let (first, second) = if is_line && straight < beside {
        (end, rachis)
    } else {
        (rachis, end)
    };
    let resolved =
        lod != Lod::Mean && !averages(&reduce(&cell, &vane, footprint), budget.threshold());
    let cut = split_line(footprint, &first, resolved);
    let mut covered = [zero; 3];
    for part in line_parts(&cut) {
        let mass = if is_line {
            part.mass * scale * line_share(&second, &part.footprint)
        } else {
            part.mass * outline.share
        };
        if mass.abs() < T::of(LEAST_PART) {
            continue;
        }
        // What the LOD pass promised of whole footprints does not hold for their parts.
        let lod = if cut.parts > 1 { parts_lod } else { lod };
        let shares = vane_coverage(&cell, &vane, &part.footprint, lod, budget);
        for (sum, share) in covered.iter_mut().zip(shares) {
            *sum = *sum + mass * share;
        }
    }
    let [barb, distal, proximal] = covered.map(|w| w.max(zero) * begun);
    [barb, distal, proximal, hook]
}

/// The same as [`cover_vane`] where averages serve: the vane has `share` of the footprint, whose mean lies over the left vane (or is
/// mirrored there); `reach`: of the barb through it. Shares of the fibres are those of averages, and all together cover what [`mean_stop`] says,
/// so that whoever asks for no fibres need not look at them.
pub fn mean_vane<T: Real>(
    card: &CardVane<T>,
    mean: [T; 2],
    reach: T,
    share: T,
    view: [T; 3],
    budget: &ErrorBudget<T>,
) -> [T; 4] {
    let (zero, one) = (T::zero(), T::one());
    if share < T::of(LEAST_SHARE) {
        return [zero, zero, zero, one];
    }
    let mut vane = card.vane;
    let [x, y] = mean;
    vane.hooked = barbule_factor(hooked(x.abs(), y, reach, card.fringe, card.downy));
    let cell = mask_vane(&vane, view);
    let nowhere = Footprint {
        mean,
        covariance: [zero; 3],
    };
    let covered = vane_coverage(&cell, &vane, &nowhere, Lod::Mean, budget).map(|w| w.max(zero));
    let sum = covered[0] + covered[1] + covered[2];
    let part = mean_stop(card, mean, reach, share, view) / sum.max(T::of(1e-9));
    let [barb, distal, proximal] = covered.map(|w| w * part);
    [barb, distal, proximal, vane.hooked]
}

/// All that such a vane covers of a footprint, where nobody asks which fibres do ([`vane_stop`]). `view`: unit.
pub fn mean_stop<T: Real>(card: &CardVane<T>, mean: [T; 2], reach: T, share: T, view: [T; 3]) -> T {
    let mut vane = card.vane;
    let [x, y] = mean;
    vane.hooked = barbule_factor(hooked(x.abs(), y, reach, card.fringe, card.downy));
    let shape = vane_shape(&vane);
    share.max(T::zero()) * vane_stop(&shape, &storeys(&shape, view))
}

/// What there is of the rachis, 0..1, where a footprint at height `v` meets it: over the last hundredth of the card it ends. A slanting
/// footprint meets it higher or lower than its middle: at the mean of its height there.
pub fn rachis_left<T: Real>(footprint: &Footprint<T>, v: T) -> T {
    let [xx, xy, _] = footprint.covariance;
    let height = v - footprint.mean[0] * xy / xx.max(T::of(LEAST_VARIANCE));
    clamp(T::of(100.0) * (T::one() - height), T::zero(), T::one())
}

/// Share of a footprint at height `v` that the rachis hides.
pub fn cover_rachis<T: Real>(footprint: &Footprint<T>, edges: [T; 2], v: T) -> T {
    rachis_share(footprint, edges) * rachis_left(footprint, v)
}

/// Rachis and both vanes ([`cover_vane`]) as shares that sum to at most 1: differences of parts may leave a little too much.
pub fn cover_feather<T: Real>(rachis: T, left: [T; 4], right: [T; 4]) -> [T; 4] {
    let weights = [
        rachis,
        left[0] + right[0],
        left[1] + right[1],
        left[2] + right[2],
    ];
    let total = weights.iter().fold(T::zero(), |sum, w| sum + *w);
    weights.map(|w| w.max(T::zero()) / total.max(T::one()))
}

/// Coverage of a footprint at height `v` of a card, seen along `view` (towards the eye; x, y, front normal).
pub fn cover<T: Real>(
    feather: &CardFeather<T, impl Fn(usize, T) -> [T; 2]>,
    footprint: &Footprint<T>,
    v: T,
    view: [T; 3],
    lod: Lod,
    budget: &ErrorBudget<T>,
) -> Coverage<T> {
    let (f, _) = footprint.widened();
    let edges = mask_rachis(feather.rachis_radius, view);
    // The outline is asked about the footprint as it is: widened, it reaches beyond the tip.
    let side = |side: usize, [f, seen]: [&Footprint<T>; 2], edge: T, view: [T; 3]| {
        let card = &feather.vanes[side];
        let cotangent = barb_cotangent(card.vane.sin_b, card.vane.cos_b);
        let reach = |root: T| (feather.reach)(side, root);
        let outline = Outline {
            reach: reach(barb_root(f.mean, cotangent)),
            share: outline_share(seen, cotangent, feather.spacing, reach),
        };
        let start = feather.start;
        cover_vane(
            card,
            start,
            &outline,
            f,
            edge,
            view,
            lod,
            Lod::Mixed,
            budget,
        )
    };
    let left = side(0, [&f, footprint], edges[0], view);
    let mirrored = [&f.mirrored(), &footprint.mirrored()];
    let right = side(1, mirrored, -edges[1], [-view[0], view[1], view[2]]);
    let [rachis, barb, distal, proximal] = cover_feather(cover_rachis(&f, edges, v), left, right);
    Coverage {
        rachis,
        barb,
        distal,
        proximal,
    }
}

/// Beyond everything, feather lengths.
const ENDLESS: f64 = 1e3;

/// Coverage of a footprint by a feather without end: two vanes, hooked everywhere, and a rachis of `rachis_radius` feather
/// lengths, seen along `view` (towards the eye; x, y, front normal).
pub fn feather_coverage<T: Real>(
    left: &Vane<T>,
    right: &Vane<T>,
    rachis_radius: T,
    footprint: &Footprint<T>,
    view: [T; 3],
    budget: &ErrorBudget<T>,
) -> Coverage<T> {
    let feather = CardFeather {
        vanes: [(*left).into(), (*right).into()],
        rachis_radius,
        start: T::of(-ENDLESS),
        reach: |_, _| [T::of(ENDLESS), T::zero()],
        spacing: T::one(),
    };
    cover(
        &feather,
        footprint,
        T::of(-ENDLESS),
        view,
        Lod::Mixed,
        budget,
    )
}
