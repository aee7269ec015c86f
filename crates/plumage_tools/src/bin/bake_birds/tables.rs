//! Tables of the scattered tracts: counts, sizes, angles, colors.

use crate::tract::Tract::{self, *};

/// One scattered tract. Spans run over phi, cranial to caudal.
pub struct TractRow {
    /// Name.
    pub name: &'static str,
    /// Tracts of the mesh it grows on.
    pub on: &'static [Tract],
    /// Feather template.
    pub feather: &'static str,
    /// Feathers on both sides together.
    pub count: u32,
    /// Rows; 0 scatters.
    pub rows: u32,
    /// Length, mm.
    pub length: (f32, f32),
    /// Width, mm.
    pub width: (f32, f32),
    /// Root angle, degrees.
    pub lift: (f32, f32),
    /// Sagitta over width.
    pub camber: f32,
    /// Bend, degrees.
    pub curl: f32,
    /// Share of its own straight line.
    pub stiffness: f32,
    /// Layer key.
    pub layer: f32,
    /// Card segments.
    pub segments: (u8, u8),
    /// sRGB at phi 0 and 1.
    pub tint: (u32, u32),
}

const fn row(
    name: &'static str,
    on: &'static [Tract],
    feather: &'static str,
    count: u32,
    rows: u32,
    length: (f32, f32),
    width: (f32, f32),
    lift: (f32, f32),
    bend: (f32, f32),
    look: (f32, f32, (u8, u8)),
    tint: (u32, u32),
) -> TractRow {
    TractRow {
        name,
        on,
        feather,
        count,
        rows,
        length,
        width,
        lift,
        camber: bend.0,
        curl: bend.1,
        stiffness: look.0,
        layer: look.1,
        segments: look.2,
        tint,
    }
}

const TRUNK: &[Tract] = &[
    Mantle,
    Back,
    Rump,
    Breast,
    Belly,
    Flank,
    Vent,
    TailUpper,
    TailUnder,
    ScapularMantle,
    Side,
];
const HEAD: (u8, u8) = (2, 2);
const CONTOUR: (u8, u8) = (4, 2);
const LESSER: (u8, u8) = (3, 2);

/// Scattered tracts of the macaw.
#[rustfmt::skip]
pub const MACAW: &[TractRow] = &[
    row("crown", &[Crown], "head", 420, 0, (8., 17.), (4.5, 7.), (10., 6.), (0.05, 10.), (0.1, 1800., HEAD), (0xC9241B, 0xC9241B)),
    row("nape", &[Nape], "head", 180, 0, (16., 24.), (8., 10.), (8., 8.), (0.06, 15.), (0.1, 1700., HEAD), (0xC9241B, 0xC9241B)),
    row("cheek", &[Cheek], "head", 500, 0, (8., 20.), (5.5, 8.), (12., 8.), (0.05, 8.), (0.1, 1900., HEAD), (0xC2221A, 0xC2221A)),
    row("face_lines", &[Bare], "face_line", 160, 5, (2., 4.), (1.2, 2.), (20., 20.), (0., 0.), (0.1, 1950., HEAD), (0xF1E4D8, 0xF1E4D8)),
    row("neck_dorsal", &[NeckDorsal], "neck", 230, 0, (20., 28.), (13., 17.), (8., 8.), (0.07, 12.), (0.2, 1600., CONTOUR), (0xC9241B, 0xC4231A)),
    row("neck_ventral", &[NeckVentral], "neck", 310, 0, (16., 28.), (11., 16.), (8., 8.), (0.07, 12.), (0.2, 1600., CONTOUR), (0xC9271C, 0xC9271C)),
    row("mantle", &[Mantle, ScapularMantle], "contour", 100, 8, (32., 46.), (20., 26.), (9., 9.), (0.08, 10.), (0.25, 1400., CONTOUR), (0xC4231A, 0xBE2A1A)),
    row("back", &[Back], "contour", 70, 6, (34., 46.), (20., 25.), (9., 9.), (0.08, 8.), (0.25, 1300., CONTOUR), (0xC4231A, 0x6A9CC8)),
    row("rump", &[Rump], "blue", 80, 8, (28., 42.), (18., 24.), (8., 8.), (0.08, 6.), (0.25, 320., CONTOUR), (0x5DA9DC, 0x5DA9DC)),
    row("scapulars", &[ScapularMantle], "contour", 56, 3, (45., 95.), (24., 32.), (7., 7.), (0.10, 8.), (0.25, 1200., CONTOUR), (0xC0301A, 0x4E7F2C)),
    row("breast", &[Breast], "contour", 160, 12, (30., 42.), (20., 25.), (10., 10.), (0.10, 18.), (0.25, 1500., CONTOUR), (0xC9271C, 0xC9271C)),
    row("belly", &[Belly], "soft", 90, 0, (32., 46.), (20., 26.), (7., 5.), (0.10, 22.), (0.05, 660., CONTOUR), (0xB8221A, 0xB8221A)),
    row("flanks", &[Flank], "soft", 110, 0, (38., 54.), (22., 30.), (6., 5.), (0.10, 22.), (0.05, 640., CONTOUR), (0xB8221A, 0xB8221A)),
    row("side", &[Side], "contour", 80, 0, (30., 36.), (20., 26.), (3., 3.), (0.06, 12.), (0., 620., CONTOUR), (0xC0241B, 0xB8221A)),
    row("vent", &[Vent], "soft", 46, 0, (28., 40.), (16., 22.), (12., 12.), (0.08, 10.), (0.25, 300., CONTOUR), (0xB8221A, 0x6BAFD8)),
    row("filler", TRUNK, "semiplume", 170, 0, (14., 22.), (14., 18.), (2., 2.), (0., 0.), (0., 0., LESSER), (0xB0584C, 0xB0584C)),
    row("lesser_upper", &[LesserUpper], "lesser", 640, 7, (14., 30.), (11., 16.), (8., 8.), (0.08, 14.), (0.5, 1000., LESSER), (0xC4231A, 0xC4231A)),
    row("elbow", &[Elbow], "lesser", 30, 0, (26., 34.), (15., 20.), (5., 4.), (0.08, 14.), (0.9, 960., LESSER), (0xE0A81A, 0xE0A81A)),
    row("marginal_upper", &[MarginalUpper], "lesser", 770, 0, (7., 15.), (5., 9.), (10., 10.), (0.10, 25.), (0.3, 1100., HEAD), (0xC4231A, 0xC4231A)),
    row("lesser_under", &[LesserUnder], "lesser", 500, 7, (13., 27.), (10., 15.), (7., 7.), (0.06, 10.), (0.5, 1000., LESSER), (0xB03020, 0xB03020)),
    row("marginal_under", &[MarginalUnder], "lesser", 416, 0, (6., 13.), (5., 8.), (8., 8.), (0.08, 15.), (0.3, 1100., HEAD), (0xB03020, 0xB03020)),
    row("femoral", &[Femoral], "leg", 230, 0, (26., 34.), (14., 19.), (6., 5.), (0.10, 22.), (0.05, 600., CONTOUR), (0xB8221A, 0xB8221A)),
    row("crural", &[Crural], "leg", 550, 0, (26., 15.), (13., 9.), (7., 6.), (0.08, 18.), (0.05, 500., LESSER), (0xB8221A, 0xA02A24)),
];

/// Scattered tracts of the golden eagle.
#[rustfmt::skip]
pub const EAGLE: &[TractRow] = &[
    row("crown", &[Crown], "head", 480, 0, (12., 26.), (6., 9.), (10., 7.), (0.06, 10.), (0.1, 1800., HEAD), (0x8B6239, 0xB07C46)),
    row("nape", &[Nape], "hackle", 150, 0, (35., 60.), (10., 14.), (9., 9.), (0.12, 10.), (0.15, 1700., CONTOUR), (0xC4924F, 0xC4924F)),
    row("face", &[Cheek, Lore], "head", 990, 0, (8., 24.), (5.5, 9.), (12., 8.), (0.05, 8.), (0.1, 1900., HEAD), (0x5E4229, 0x7E5C38)),
    row("lore", &[Lore], "bristle", 70, 0, (6., 12.), (1., 1.5), (25., 25.), (0., 0.), (0.5, 1950., (2, 1)), (0x3A2A1C, 0x3A2A1C)),
    row("neck_dorsal", &[NeckDorsal], "hackle", 250, 0, (40., 60.), (13., 16.), (9., 9.), (0.12, 12.), (0.2, 1600., CONTOUR), (0xB98548, 0x7A5632)),
    row("neck_ventral", &[NeckVentral], "contour", 300, 0, (26., 48.), (14., 21.), (9., 9.), (0.08, 14.), (0.2, 1600., CONTOUR), (0x5E4229, 0x5A4029)),
    row("mantle", &[Mantle, ScapularMantle], "contour", 70, 6, (55., 80.), (32., 42.), (8., 8.), (0.09, 10.), (0.25, 1400., CONTOUR), (0x46321F, 0x46321F)),
    row("back", &[Back], "contour", 50, 5, (55., 75.), (32., 40.), (9., 9.), (0.08, 8.), (0.25, 1300., CONTOUR), (0x46321F, 0x46321F)),
    row("rump", &[Rump], "contour", 60, 6, (50., 80.), (30., 40.), (8., 8.), (0.08, 6.), (0.25, 320., CONTOUR), (0x5A4230, 0x5A4230)),
    row("scapulars", &[ScapularMantle], "contour", 52, 3, (70., 150.), (40., 60.), (6., 6.), (0.10, 8.), (0.25, 1200., (5, 2)), (0x42301F, 0x42301F)),
    row("breast", &[Breast], "contour", 140, 9, (50., 70.), (30., 38.), (10., 10.), (0.10, 18.), (0.25, 1500., CONTOUR), (0x4A3524, 0x4A3524)),
    row("belly", &[Belly], "soft", 84, 0, (55., 78.), (34., 44.), (7., 5.), (0.10, 22.), (0.05, 660., CONTOUR), (0x4A3524, 0x4A3524)),
    row("flanks", &[Flank], "soft", 84, 0, (62., 92.), (36., 48.), (6., 5.), (0.10, 22.), (0.05, 640., CONTOUR), (0x45321F, 0x4C3724)),
    row("side", &[Side], "contour", 56, 0, (55., 66.), (34., 42.), (3., 3.), (0.06, 12.), (0., 620., CONTOUR), (0x48331F, 0x45321F)),
    row("vent", &[Vent], "soft", 36, 0, (50., 80.), (28., 38.), (12., 12.), (0.08, 10.), (0.25, 300., CONTOUR), (0x6B4E35, 0x6B4E35)),
    row("filler", TRUNK, "semiplume", 60, 0, (26., 42.), (28., 36.), (2., 2.), (0., 0.), (0., 0., LESSER), (0x7A6650, 0x7A6650)),
    row("lesser_upper", &[LesserUpper], "lesser", 540, 7, (30., 62.), (22., 34.), (8., 8.), (0.08, 14.), (0.5, 1000., LESSER), (0x5A4230, 0x5A4230)),
    row("elbow", &[Elbow], "lesser", 40, 0, (52., 66.), (30., 38.), (5., 4.), (0.08, 14.), (0.9, 960., LESSER), (0x5A4230, 0x6A5038)),
    row("marginal_upper", &[MarginalUpper], "lesser", 680, 0, (13., 28.), (10., 16.), (10., 10.), (0.10, 25.), (0.3, 1100., HEAD), (0x6B4E33, 0x6B4E33)),
    row("lesser_under", &[LesserUnder], "lesser", 380, 6, (28., 58.), (22., 32.), (7., 7.), (0.06, 10.), (0.5, 1000., LESSER), (0x4A3524, 0x4A3524)),
    row("marginal_under", &[MarginalUnder], "lesser", 354, 0, (10., 26.), (8., 15.), (8., 8.), (0.08, 15.), (0.3, 1100., HEAD), (0x523B27, 0x523B27)),
    row("femoral", &[Femoral], "trouser", 180, 0, (50., 72.), (26., 34.), (6., 5.), (0.10, 22.), (0.05, 600., CONTOUR), (0x4E3627, 0x5C402C)),
    row("crural", &[Crural], "trouser", 540, 0, (70., 42.), (27., 20.), (7., 6.), (0.10, 20.), (0.05, 500., CONTOUR), (0x5C402C, 0x8A6A4A)),
    row("tarsal", &[Tarsal], "tarsal", 300, 0, (34., 20.), (20., 14.), (7., 6.), (0.06, 14.), (0.05, 480., LESSER), (0x9A7B58, 0x9A7B58)),
];

/// Feather templates of a bird, in the order of their numbers.
pub fn templates(parrot: bool) -> &'static [&'static str] {
    if parrot {
        &[
            "head",
            "face_line",
            "neck",
            "contour",
            "soft",
            "blue",
            "semiplume",
            "lesser",
            "greater",
            "primary",
            "secondary",
            "rectrix",
            "leg",
        ]
    } else {
        &[
            "head",
            "bristle",
            "hackle",
            "contour",
            "soft",
            "semiplume",
            "lesser",
            "greater",
            "primary",
            "secondary",
            "rectrix",
            "trouser",
            "tarsal",
        ]
    }
}

/// One kind of flight-feather row: lengths along the row, width, lift, camber, curl, color.
pub struct RowLook {
    /// Row name.
    pub name: &'static str,
    /// Template.
    pub feather: &'static str,
    /// Feathers on one side.
    pub count: usize,
    /// Lengths at both ends when not listed one by one, mm.
    pub length: (f32, f32),
    /// Widths at both ends, mm.
    pub width: (f32, f32),
    /// Lift, camber, curl.
    pub bend: (f32, f32, f32),
    /// Segments.
    pub segments: (u8, u8),
    /// sRGB at both ends.
    pub tint: (u32, u32),
}

const fn look(
    name: &'static str,
    feather: &'static str,
    count: usize,
    length: (f32, f32),
    width: (f32, f32),
    bend: (f32, f32, f32),
    segments: (u8, u8),
    tint: (u32, u32),
) -> RowLook {
    RowLook {
        name,
        feather,
        count,
        length,
        width,
        bend,
        segments,
        tint,
    }
}

/// Rows of the macaw.
#[rustfmt::skip]
pub const MACAW_ROWS: &[RowLook] = &[
    look("primaries", "primary", 10, (0., 0.), (46., 28.), (0., 0.06, 3.), (14, 4), (0x1F3F9C, 0x1F3F9C)),
    look("secondaries", "secondary", 12, (0., 0.), (48., 46.), (0., 0.09, 10.), (12, 4), (0x2450AE, 0x2E6F86)),
    look("alula", "primary", 4, (45., 85.), (14., 20.), (3., 0.06, 8.), (6, 2), (0x1F46A6, 0x1F46A6)),
    look("primary_coverts", "greater", 10, (70., 110.), (24., 20.), (1.5, 0.07, 8.), (6, 2), (0x2450AE, 0x2450AE)),
    look("greater_coverts", "greater", 12, (78., 58.), (28., 34.), (5., 0.09, 10.), (6, 2), (0xF2BC14, 0xF2BC14)),
    look("median_primary", "greater", 9, (46., 34.), (24., 20.), (6., 0.09, 12.), (4, 2), (0xE0B81A, 0x2450AE)),
    look("median_secondary", "greater", 12, (52., 38.), (22., 28.), (6., 0.09, 12.), (4, 2), (0xF5C21A, 0xF5C21A)),
    look("under_primary", "greater", 10, (70., 95.), (28., 20.), (3., 0.06, 6.), (5, 2), (0xB0482A, 0xB0482A)),
    look("under_secondary", "greater", 12, (80., 55.), (24., 28.), (3., 0.06, 6.), (5, 2), (0xB0482A, 0xB0482A)),
    look("under_median_primary", "lesser", 10, (40., 28.), (20., 16.), (4., 0.06, 8.), (3, 2), (0xA8381F, 0xA8381F)),
    look("under_median_secondary", "lesser", 12, (45., 32.), (20., 22.), (4., 0.06, 8.), (3, 2), (0xA8381F, 0xA8381F)),
    look("axillaries", "soft", 9, (50., 80.), (20., 26.), (5., 0.05, 5.), (4, 2), (0xB03020, 0xB03020)),
    look("rectrices", "rectrix", 6, (0., 0.), (34., 30.), (0., 0.12, 4.), (18, 4), (0xA8281C, 0x1F46A6)),
];

/// Rows of the eagle.
#[rustfmt::skip]
pub const EAGLE_ROWS: &[RowLook] = &[
    look("primaries", "primary", 10, (0., 0.), (72., 42.), (0., 0.06, 4.), (16, 4), (0x33271F, 0x33271F)),
    look("secondaries", "secondary", 17, (0., 0.), (75., 66.), (0., 0.09, 10.), (12, 4), (0x3B2E25, 0x3B2E25)),
    look("alula", "primary", 4, (90., 170.), (26., 36.), (3., 0.06, 8.), (6, 2), (0x33271F, 0x33271F)),
    look("primary_coverts", "greater", 10, (130., 190.), (38., 32.), (1.5, 0.07, 8.), (6, 2), (0x3A2B1F, 0x3A2B1F)),
    look("greater_coverts", "greater", 14, (140., 105.), (44., 54.), (5., 0.09, 10.), (6, 2), (0x4A3726, 0x4A3726)),
    look("median_primary", "greater", 10, (80., 65.), (40., 34.), (6., 0.09, 12.), (4, 2), (0x6A5038, 0x5A4430)),
    look("median_secondary", "greater", 15, (95., 70.), (38., 46.), (6., 0.09, 12.), (4, 2), (0x7E6042, 0x463423)),
    look("under_primary", "greater", 10, (120., 150.), (46., 36.), (3., 0.06, 6.), (5, 2), (0x5F5348, 0x5F5348)),
    look("under_secondary", "greater", 14, (130., 95.), (40., 46.), (3., 0.06, 6.), (5, 2), (0x5F5348, 0x5F5348)),
    look("under_median_primary", "lesser", 11, (70., 55.), (34., 28.), (4., 0.06, 8.), (3, 2), (0x4A3828, 0x4A3828)),
    look("under_median_secondary", "lesser", 15, (80., 60.), (34., 36.), (4., 0.06, 8.), (3, 2), (0x4A3828, 0x4A3828)),
    look("axillaries", "soft", 14, (90., 150.), (34., 44.), (5., 0.05, 5.), (4, 2), (0x45321F, 0x45321F)),
    look("rectrices", "rectrix", 6, (0., 0.), (62., 58.), (0., 0.10, 4.), (12, 4), (0x4E443B, 0x4E443B)),
];

/// Lengths that are listed one by one: primaries P1..P10, secondaries then tertials, rectrices R1..R6.
pub fn lengths(parrot: bool) -> [Vec<f32>; 3] {
    let ramp =
        |a: f32, b: f32, n: usize| (0..n).map(move |i| a + (b - a) * i as f32 / (n - 1) as f32);
    if parrot {
        [
            vec![195., 205., 218., 235., 256., 280., 303., 318., 325., 312.],
            ramp(185., 165., 9).chain([150., 135., 115.]).collect(),
            vec![460., 405., 340., 275., 225., 185.],
        ]
    } else {
        [
            vec![310., 325., 343., 371., 418., 465., 493., 489., 451., 362.],
            ramp(325., 300., 13)
                .chain([280., 240., 200., 165.])
                .collect(),
            vec![345., 350., 350., 345., 338., 325.],
        ]
    }
}

/// Tail coverts: feathers of one side per row (caudal row first) above and below, lengths caudal to cranial, widths, colors.
pub struct TailCoverts {
    /// Rows above and below.
    pub rows: [&'static [usize]; 2],
    /// Lengths of the most caudal and the most cranial row.
    pub length: [(f32, f32); 2],
    /// Widths likewise.
    pub width: (f32, f32),
    /// Templates.
    pub feather: [&'static str; 2],
    /// sRGB.
    pub tint: [u32; 2],
}

/// Tail coverts of a bird.
pub fn tail_coverts(parrot: bool) -> TailCoverts {
    if parrot {
        TailCoverts {
            rows: [&[6, 6, 6, 5], &[7, 6, 6, 6]],
            length: [(120., 40.), (130., 40.)],
            width: (26., 18.),
            feather: ["blue", "blue"],
            tint: [0x5DA9DC, 0x6BAFD8],
        }
    } else {
        TailCoverts {
            rows: [&[6, 6, 6, 6], &[6, 6, 6, 5, 5]],
            length: [(160., 70.), (170., 70.)],
            width: (42., 32.),
            feather: ["contour", "soft"],
            tint: [0x6B4E35, 0x75563A],
        }
    }
}
