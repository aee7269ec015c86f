#define_import_path bevy_plumage::down_transfer

// Precomputed radiance transfer of a tile in four numbers a cell. Twin of src/maths/undercoat/harmonics.rs and
// src/maths/undercoat/transfer/four.rs,
// where the comments are.

// The open share of the sphere and the bent vector of one cell, in the frame of the light.
struct Four {
    bent: vec3<f32>,
    openness: f32,
}

// Polynomials of bands 2 to 4, row by row (30 numbers), the length of the longest bent vector, the most that a light's share can
// be. The layout of
// `TransferBands::vec4s`.
struct TransferBands {
    fit: array<vec4<f32>, 8>,
}

// Zonal coefficients of the five bands.
struct Zonal {
    zero: f32,
    one: f32,
    higher: vec3<f32>,
}

// Basis functions of band 2 in the unit direction `d`, m = -2 to 1, and m = 2.
struct BandTwo {
    first: vec4<f32>,
    last: f32,
}

// Basis functions of band 1, m = -1, 0, 1.
fn harmonics_one(d: vec3<f32>) -> vec3<f32> {
    return 0.4886025119 * d.yzx;
}

fn harmonics_two(d: vec3<f32>) -> BandTwo {
    let first = vec4(
        1.0925484306 * d.x * d.y,
        1.0925484306 * d.y * d.z,
        0.3153915653 * (3.0 * d.z * d.z - 1.0),
        1.0925484306 * d.x * d.z,
    );
    return BandTwo(first, 0.5462742153 * (d.x * d.x - d.y * d.y));
}

// The 25 basis functions of bands 0 to 4.
fn harmonics(d: vec3<f32>) -> array<f32, 25> {
    let s = d * d;
    let difference = s.x - s.y;
    let left = d.x * (s.x - 3.0 * s.y);
    let right = d.y * (3.0 * s.x - s.y);
    let five = 5.0 * s.z - 1.0;
    let seven = 7.0 * s.z;
    let one = harmonics_one(d);
    let two = harmonics_two(d);
    return array<f32, 25>(
        0.2820947918,
        one.x,
        one.y,
        one.z,
        two.first.x,
        two.first.y,
        two.first.z,
        two.first.w,
        two.last,
        0.5900435899 * right,
        2.8906114426 * d.x * d.y * d.z,
        0.4570457995 * d.y * five,
        0.3731763326 * d.z * (5.0 * s.z - 3.0),
        0.4570457995 * d.x * five,
        1.4453057213 * d.z * difference,
        0.5900435899 * left,
        2.5033429418 * d.x * d.y * difference,
        1.7701307698 * d.z * right,
        0.9461746958 * d.x * d.y * (seven - 1.0),
        0.6690465436 * d.y * d.z * (seven - 3.0),
        0.1057855469 * ((35.0 * s.z - 30.0) * s.z + 3.0),
        0.6690465436 * d.x * d.z * (seven - 3.0),
        0.4730873479 * difference * (seven - 1.0),
        1.7701307698 * d.z * left,
        0.6258357354 * (s.x * (s.x - 6.0 * s.y) + s.y * s.y),
    );
}

// Legendre polynomials P_2 to P_4.
fn legendre(x: f32) -> vec3<f32> {
    let s = x * x;
    return vec3(1.5 * s - 0.5, x * (2.5 * s - 1.5), (4.375 * s - 3.75) * s + 0.375);
}

// A texel of the packed texture as it was.
fn transfer_decode(texel: vec4<f32>, bands: TransferBands) -> Four {
    return Four((2.0 * texel.xyz - 1.0) * bands.fit[7].z, texel.w);
}

// The cell turned with the skin: `frame` has the world directions of the tile's x, y and z as columns.
fn transfer_rotate(four: Four, frame: mat3x3<f32>) -> Four {
    return Four(frame * four.bent, four.openness);
}

// Direction of the bent vector; z for none.
fn transfer_axis(bent: vec3<f32>) -> vec3<f32> {
    let l = length(bent);
    return select(vec3(0.0, 0.0, 1.0), bent / max(l, 1e-6), l > 1e-6);
}

fn transfer_bands(four: Four, bands: TransferBands) -> Zonal {
    let a = clamp(four.openness, 0.0, 1.0);
    let l = min(length(four.bent), a);
    let c = 4.0 * l;
    let low = vec4(1.0, a, c, a * a);
    let middle = vec4(a * c, c * c, a * a * a, a * a * c);
    let high = vec2(a * c * c, c * c * c);
    let f = bands.fit;
    let two = dot(f[0], low) + dot(f[1], middle) + dot(f[2].xy, high);
    // Row 3 begins at number 10, row 4 at number 20: the eleventh and the twenty-first.
    let three = dot(vec4(f[2].zw, f[3].xy), low) + dot(vec4(f[3].zw, f[4].xy), middle) + dot(f[4].zw, high);
    let four_sum = dot(f[5], low) + dot(f[6], middle) + dot(f[7].xy, high);
    return Zonal(a, l, clamp(vec3(two, three, four_sum), vec3(-a), vec3(a)));
}

// Mean radiance that reaches the cell from an environment of bands 0 to 2.
fn transfer_zonal(four: Four, bands: TransferBands, light: array<vec3<f32>, 9>) -> vec3<f32> {
    let z = transfer_bands(four, bands);
    let d = transfer_axis(four.bent);
    let one = z.one * harmonics_one(d);
    let two = harmonics_two(d);
    var sum = z.zero * 0.2820947918 * light[0];
    sum += one.x * light[1] + one.y * light[2] + one.z * light[3];
    sum += z.higher.x * (two.first.x * light[4] + two.first.y * light[5] + two.first.z * light[6]
        + two.first.w * light[7] + two.last * light[8]);
    return max(sum, vec3(0.0));
}

// The same with bands 0 to 4.
fn transfer_zonal_full(four: Four, bands: TransferBands, light: array<vec3<f32>, 25>) -> vec3<f32> {
    let z = transfer_bands(four, bands);
    let y = harmonics(transfer_axis(four.bent));
    var sum = z.zero * y[0] * light[0];
    for (var i = 1u; i < 25u; i++) {
        var weight = z.one;
        if i >= 16u {
            weight = z.higher.z;
        } else if i >= 9u {
            weight = z.higher.y;
        } else if i >= 4u {
            weight = z.higher.x;
        }
        sum += weight * y[i] * light[i];
    }
    return max(sum, vec3(0.0));
}

// Share of a light in the unit direction `light` that reaches the cell.
fn transfer_towards(four: Four, bands: TransferBands, light: vec3<f32>) -> f32 {
    let z = transfer_bands(four, bands);
    let x = clamp(dot(transfer_axis(four.bent), light), -1.0, 1.0);
    let sum = z.zero + 3.0 * z.one * x + dot(z.higher * vec3(5.0, 7.0, 9.0), legendre(x));
    return clamp(sum, 0.0, bands.fit[7].w);
}
