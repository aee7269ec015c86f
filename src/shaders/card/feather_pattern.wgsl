// A fixed pattern that turns coverage into holes or MSAA samples without flicker: the same pixel and card, the same value.
#define_import_path bevy_plumage::feather_pattern

// Integer hash (PCG, O'Neill 2014).
fn hash(value: u32) -> u32 {
    let state = value * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// Bits of which each depends on itself and those below (hash of Laine and Karras; Burley 2020, "Practical Hash-based Owen Scrambling",
// Sec. 3): of a reversed index, an order in which aligned blocks of a power of two stay together.
fn shuffled(reversed: u32, seed: u32) -> u32 {
    var x = reversed + seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

// By how much of 2^32 a frame moves thresholds and samples, for every seed independently: the first two dimensions of the sequence of
// Sobol. Of aligned frames four lie in the four quarters of either, sixteen in the sixteen sixteenths, and so on. Frame 0 moves nothing.
fn frame_point(frame: u32, seed: u32) -> vec2<u32> {
    if (frame == 0u) {
        return vec2(0u);
    }
    let first = shuffled(reverseBits(frame), seed) ^ shuffled(0u, seed);
    // Pascal's triangle modulo 2.
    var second = first;
    second ^= (second & 0x55555555u) << 1u;
    second ^= (second & 0x33333333u) << 2u;
    second ^= (second & 0x0f0f0f0fu) << 4u;
    second ^= (second & 0x00ff00ffu) << 8u;
    second ^= second << 16u;
    return vec2(first, second);
}

// A share of 2^32.
fn share_of(part: u32) -> f32 { return f32(part >> 8u) / 16777216.0; }

// A threshold moved on by a share, in (0, 1).
fn threshold_after(threshold: f32, by: u32) -> f32 { return clamp(fract(threshold + share_of(by)), 0.002, 0.998); }

// In (0, 1): interleaved gradient noise (Jimenez 2014) shifted by the card, so that stacked cards are not holed alike.
fn pattern_threshold(pixel: vec2<f32>, card: u32) -> f32 {
    let gradient = fract(52.9829189 * fract(dot(floor(pixel), vec2(0.06711056, 0.00583715))));
    let shift = share_of(hash(card));
    return clamp(fract(gradient + shift), 0.002, 0.998);
}

// `samples` bits of which alpha x samples are set, their mean over the thresholds exactly that; which ones depends on `turn`,
// so that feathers behind each other do not all leave the same samples open.
fn sample_mask(alpha: f32, threshold: f32, turn: u32, samples: u32) -> u32 {
    let count = min(u32(max(alpha, 0.0) * f32(samples) + threshold), samples);
    let all = (1u << samples) - 1u;
    let bits = (1u << count) - 1u;
    let by = turn % samples;
    return ((bits << by) | (bits >> (samples - by))) & all;
}

fn cell_value(cell: vec2<f32>, seed: u32) -> f32 {
    let i = vec2<i32>(cell);
    return share_of(hash(bitcast<u32>(i.x) ^ hash(bitcast<u32>(i.y) ^ seed)));
}

// A threshold in (0, 1), even over the cells of a lattice on the card about a pixel wide: it moves with the card, not with the
// screen (Wyman and McGuire 2017, "Hashed Alpha Testing", Sec. 4).
fn hashed_threshold(point: vec2<f32>, dx: vec2<f32>, dy: vec2<f32>, seed: u32) -> f32 {
    let step = max(max(length(dx), length(dy)), 1e-9);
    let level = -log2(step);
    let fine = exp2(ceil(level));
    let coarse = exp2(floor(level));
    let f = level - floor(level);
    let x = mix(cell_value(floor(point * coarse), seed), cell_value(floor(point * fine), hash(seed)), f);
    // A mix of two even values is not even: its distribution function makes it so.
    let m = max(min(f, 1.0 - f), 1e-4);
    let scale = 1.0 / (2.0 * m * (1.0 - m));
    var even = (x - 0.5 * m) / (1.0 - m);
    if (x < m) { even = x * x * scale; }
    if (x > 1.0 - m) { even = 1.0 - (1.0 - x) * (1.0 - x) * scale; }
    return clamp(even, 0.002, 0.998);
}
