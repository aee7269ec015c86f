#define_import_path bevy_plumage::query_map

// How distant footprints look at an outline: in a map of the card that is averaged beforehand. Twin of src/maths/query/map.rs, where the
// derivation is.

// Texels of the map's first level, across and along the card.
const MAP_SIZE: vec2<f32> = vec2(64.0, 128.0);
const LAST_MAP_LEVEL: f32 = 5.0;
// Texels of them beyond each edge of the card.
const MAP_MARGIN: f32 = 4.0;
// Most looks for one footprint.
const MAX_MAP_LOOKS: u32 = 16u;
// Least standard deviation of a footprint along its shorter axis, in texels, for which the map serves.
const FINEST_MAP_SIGMA: f32 = 0.4;
// Deviations of a footprint, from its middle, beyond which nothing of it counts.
const WHOLE_SIGMAS: f32 = 2.5;
// Share from which on all of a look counts as inside: maps hold steps of a 255th.
const WHOLE_SHARE: f32 = 0.999;
// Looks that a variance along a footprint of one look's variance needs, less one.
const LOOKS_PER_VARIANCE: f32 = 0.44444445;

// How a footprint looks at the map: `count` times, `step` apart, on a level; whether the map serves. Where it does not, one look on the
// level may still decide (map_decided).
struct MapSight {
    step: vec2<f32>,
    level: f32,
    count: u32,
    serves: bool,
}

// Place on the map of a point of the card.
fn map_place(uv: vec2<f32>) -> vec2<f32> {
    return (uv * (MAP_SIZE - MAP_MARGIN - MAP_MARGIN) + MAP_MARGIN) / MAP_SIZE;
}

// The level of a look of this variance, in texels of the first level.
fn map_level(variance: f32) -> f32 {
    let times = 4.0 * variance;
    let low = floor(0.5 * log2(times));
    let share = (times * exp2(-2.0 * low) - 1.0) * (1.0 / 3.0);
    return min(low + clamp(share, 0.0, 1.0), LAST_MAP_LEVEL);
}

// The level on which one look sees all texels within WHOLE_SIGMAS of a footprint's middle, by its variance along the longer axis; beyond
// LAST_MAP_LEVEL none does.
fn whole_level(major: f32) -> f32 {
    return max(ceil(log2(2.0 * WHOLE_SIGMAS) + 0.5 * log2(major)), 0.0);
}

// What such a look says of a finer footprint: 1 where all around is inside, 0 where nothing is, else -1.
fn map_decided(share: f32, level: f32) -> f32 {
    if (level > LAST_MAP_LEVEL) {
        return -1.0;
    }
    return select(select(-1.0, 1.0, share >= WHOLE_SHARE), 0.0, share <= 0.0);
}

// How a pixel looks at the map whose derivatives of `uv` along both axes of the screen are these.
fn map_sight(duv_dx: vec2<f32>, duv_dy: vec2<f32>) -> MapSight {
    let texels = MAP_SIZE - 2.0 * MAP_MARGIN;
    let a = duv_dx * texels;
    let b = duv_dy * texels;
    let cov = 0.25 * vec3(a.x * a.x + b.x * b.x, a.x * a.y + b.x * b.y, a.y * a.y + b.y * b.y);
    let mean = 0.5 * (cov.x + cov.z);
    let d = 0.5 * (cov.x - cov.z);
    let r = sqrt(d * d + cov.y * cov.y);
    let major = clamp(mean + r, 1e-6, 1e8);
    let narrow = mean - r;
    let looks = f32(MAX_MAP_LOOKS - 1u);
    let minor = clamp(max(narrow, major / (1.0 + looks / LOOKS_PER_VARIANCE)), 1e-6, 1e8);
    let seen = max(minor, 0.25);
    let rest = max(major - seen, 0.0);
    let more = clamp(ceil(LOOKS_PER_VARIANCE * rest / seen), 0.0, looks);
    let along = select(vec2(cov.y, r - d), vec2(r + d, cov.y), d >= 0.0);
    let spread = sqrt(4.0 * rest / max(more, 1.0)) / max(length(along), 1e-12);
    let serves = narrow >= FINEST_MAP_SIGMA * FINEST_MAP_SIGMA;
    return MapSight(
        along * spread / MAP_SIZE,
        select(whole_level(major), map_level(seen), serves),
        1u + min(u32(more), MAX_MAP_LOOKS - 1u),
        serves,
    );
}

// Factor on a look: beyond the map nothing is inside. `texels`: of the level, across and along.
fn map_border(place: vec2<f32>, texels: vec2<f32>) -> f32 {
    let share = clamp(0.5 + min(place, 1.0 - place) * texels, vec2(0.0), vec2(1.0));
    return share.x * share.y;
}

// Left and right: what a rachis leaves of both vanes.
fn map_vanes(inside: f32, rachis: f32, beside: vec2<f32>) -> vec2<f32> {
    return max(inside - rachis, 0.0) * beside / max(beside.x + beside.y, 1e-6);
}
