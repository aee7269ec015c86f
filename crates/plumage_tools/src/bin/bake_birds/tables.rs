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
    row("crown", &[Crown], "head", 420, 0, (8., 17.), (4.5, 7.), (10., 6.), (0.05, 10.), (0.1, 1800., HEAD), (0xD23A1E, 0xD23A1E)),
    row("nape", &[Nape], "head", 180, 0, (16., 24.), (8., 10.), (8., 8.), (0.06, 15.), (0.1, 1700., HEAD), (0xD23A1E, 0xD23A1E)),
    row("cheek", &[Cheek], "head", 540, 0, (8., 20.), (5.5, 8.), (12., 8.), (0.05, 8.), (0.1, 1900., HEAD), (0xCE381C, 0xCE381C)),
    row("face_lines", &[Bare], "face_line", 160, 5, (2., 4.), (1.2, 2.), (20., 20.), (0., 0.), (0.1, 1950., HEAD), (0xF1E4D8, 0xF1E4D8)),
    row("neck_dorsal", &[NeckDorsal], "neck", 230, 0, (20., 28.), (13., 17.), (8., 8.), (0.07, 12.), (0.2, 1600., CONTOUR), (0xD23A1E, 0xC8361D)),
    row("neck_ventral", &[NeckVentral], "neck", 340, 0, (16., 28.), (11., 16.), (8., 8.), (0.07, 12.), (0.2, 1600., CONTOUR), (0xCC361D, 0xCC361D)),
    row("mantle", &[Mantle, ScapularMantle], "contour", 108, 8, (32., 46.), (20., 26.), (9., 9.), (0.06, 10.), (0.25, 1400., CONTOUR), (0xC8361D, 0xC4381D)),
    row("back", &[Back], "contour", 70, 6, (34., 46.), (20., 25.), (9., 9.), (0.06, 8.), (0.25, 1300., CONTOUR), (0xC83A1E, 0xC4361C)),
    row("rump", &[Rump], "blue", 80, 8, (28., 42.), (18., 24.), (8., 8.), (0.08, 6.), (0.25, 320., CONTOUR), (0x5DA9DC, 0x5DA9DC)),
    row("scapulars", &[ScapularMantle], "contour", 80, 5, (50., 94.), (24., 30.), (9., 7.), (0.05, 8.), (0.25, 1200., (5, 2)), (0xC8361D, 0xC4361C)),
    row("breast", &[Breast], "contour", 125, 12, (30., 42.), (20., 25.), (10., 6.), (0.05, 18.), (0.25, 1500., CONTOUR), (0xCC361D, 0xCC361D)),
    row("belly", &[Belly], "soft", 90, 0, (32., 46.), (20., 26.), (7., 5.), (0.05, 22.), (0.05, 660., CONTOUR), (0xC0301B, 0xC0301B)),
    row("flanks", &[Flank], "soft", 170, 0, (32., 46.), (18., 24.), (4., 3.), (0.05, 22.), (0.05, 640., CONTOUR), (0xC0301B, 0xC0301B)),
    row("side", &[Side], "contour", 163, 0, (28., 34.), (16., 20.), (2., 2.), (0.06, 12.), (0., 620., CONTOUR), (0xC6341C, 0xC0301B)),
    row("vent", &[Vent], "blue", 46, 0, (24., 34.), (15., 20.), (5., 5.), (0.05, 10.), (0.25, 300., CONTOUR), (0x6BAFD8, 0x6BAFD8)),
    row("filler", TRUNK, "semiplume", 200, 0, (14., 22.), (14., 18.), (2., 2.), (0., 0.), (0., 0., LESSER), (0xB0584C, 0xB0584C)),
    row("lesser_upper", &[LesserUpper], "lesser", 540, 7, (14., 28.), (11., 16.), (6., 6.), (0.04, 14.), (0.5, 1000., LESSER), (0xC8361D, 0xC8361D)),
    row("elbow", &[Elbow], "lesser", 30, 0, (26., 34.), (15., 20.), (5., 4.), (0.04, 14.), (0.9, 960., LESSER), (0xEDB414, 0xF2BC14)),
    row("marginal_upper", &[MarginalUpper], "lesser", 740, 0, (7., 15.), (5., 9.), (6., 6.), (0.05, 16.), (0.3, 1100., HEAD), (0xC8361D, 0xC8361D)),
    row("lesser_under", &[LesserUnder], "lesser", 340, 7, (14., 28.), (11., 16.), (7., 7.), (0.06, 10.), (0.5, 1000., LESSER), (0xB03020, 0xB03020)),
    row("marginal_under", &[MarginalUnder], "lesser", 466, 0, (6., 13.), (5., 8.), (8., 8.), (0.08, 15.), (0.3, 1100., HEAD), (0xB03020, 0xB03020)),
    row("femoral", &[Femoral], "leg", 230, 0, (26., 34.), (14., 19.), (6., 5.), (0.10, 22.), (0.05, 600., CONTOUR), (0xC0301B, 0xC0301B)),
    row("crural", &[Crural], "leg", 550, 0, (26., 15.), (13., 9.), (7., 6.), (0.08, 18.), (0.05, 500., LESSER), (0xC0301B, 0xB02C1C)),
];

/// Scattered tracts of the golden eagle.
#[rustfmt::skip]
pub const EAGLE: &[TractRow] = &[
    row("crown", &[Crown], "head", 480, 0, (12., 26.), (6., 9.), (10., 7.), (0.06, 10.), (0.1, 1800., HEAD), (0x856F58, 0xB08A62)),
    row("nape", &[Nape], "hackle", 150, 0, (35., 60.), (10., 14.), (9., 9.), (0.12, 10.), (0.15, 1700., CONTOUR), (0xC49F6D, 0xC49F6D)),
    row("face", &[Cheek, Lore], "head", 956, 0, (8., 24.), (5.5, 9.), (12., 8.), (0.05, 8.), (0.1, 1900., HEAD), (0x5A4B3D, 0x615141)),
    row("lore", &[Lore], "bristle", 70, 0, (6., 12.), (1., 1.5), (25., 25.), (0., 0.), (0.5, 1950., (2, 1)), (0x382F27, 0x382F27)),
    row("neck_dorsal", &[NeckDorsal], "hackle", 250, 0, (40., 72.), (13., 16.), (9., 9.), (0.08, 12.), (0.2, 1600., CONTOUR), (0xB99365, 0x75614D)),
    row("neck_ventral", &[NeckVentral], "body", 300, 0, (26., 56.), (14., 21.), (9., 9.), (0.08, 14.), (0.2, 1600., CONTOUR), (0x5A4B3D, 0x4A3E34)),
    row("mantle", &[Mantle, ScapularMantle], "body", 88, 6, (55., 80.), (32., 42.), (8., 8.), (0.06, 10.), (0.25, 1400., CONTOUR), (0x43382D, 0x43382D)),
    row("back", &[Back], "body", 50, 5, (55., 75.), (32., 40.), (9., 9.), (0.06, 8.), (0.25, 1300., CONTOUR), (0x43382D, 0x43382D)),
    row("rump", &[Rump], "body", 60, 6, (50., 80.), (30., 40.), (8., 8.), (0.08, 6.), (0.25, 320., CONTOUR), (0x56493F, 0x56493F)),
    row("scapulars", &[ScapularMantle], "contour", 90, 5, (88., 150.), (41., 52.), (9., 7.), (0.05, 8.), (0.25, 1200., (5, 2)), (0x4A3F35, 0x463B32)),
    row("breast", &[Breast], "body", 168, 11, (46., 62.), (25., 32.), (10., 6.), (0.07, 18.), (0.25, 1500., CONTOUR), (0x4A3E34, 0x463B32)),
    row("belly", &[Belly], "soft", 94, 0, (55., 78.), (34., 44.), (7., 5.), (0.07, 22.), (0.05, 660., CONTOUR), (0x473B32, 0x473B32)),
    row("flanks", &[Flank], "soft", 140, 0, (52., 70.), (30., 40.), (4., 3.), (0.07, 22.), (0.05, 640., CONTOUR), (0x42382D, 0x493D33)),
    row("side", &[Side], "body", 98, 0, (50., 58.), (28., 34.), (2., 2.), (0.06, 12.), (0., 620., CONTOUR), (0x45392E, 0x42382D)),
    row("vent", &[Vent], "soft", 36, 0, (50., 80.), (28., 38.), (12., 12.), (0.05, 10.), (0.25, 300., CONTOUR), (0x675749, 0x675749)),
    row("filler", TRUNK, "semiplume", 60, 0, (26., 42.), (28., 36.), (2., 2.), (0., 0.), (0., 0., LESSER), (0x756A5E, 0x756A5E)),
    row("lesser_upper", &[LesserUpper], "lesser", 540, 7, (30., 62.), (22., 34.), (8., 8.), (0.04, 14.), (0.5, 1000., LESSER), (0x56493E, 0x52463B)),
    row("elbow", &[Elbow], "lesser", 40, 0, (40., 48.), (28., 34.), (2., 2.), (0.04, 14.), (0.3, 960., LESSER), (0x52463B, 0x52463B)),
    row("marginal_upper", &[MarginalUpper], "body", 660, 0, (13., 28.), (10., 16.), (6., 6.), (0.05, 16.), (0.3, 1100., HEAD), (0x4A3E34, 0x52463B)),
    row("lesser_under", &[LesserUnder], "lesser", 246, 6, (28., 58.), (22., 32.), (7., 7.), (0.06, 10.), (0.5, 1000., LESSER), (0x473B32, 0x473B32)),
    row("marginal_under", &[MarginalUnder], "lesser", 430, 0, (10., 26.), (8., 15.), (8., 8.), (0.08, 15.), (0.3, 1100., HEAD), (0x4F4237, 0x4F4237)),
    row("femoral", &[Femoral], "trouser", 210, 0, (50., 72.), (26., 34.), (6., 5.), (0.07, 22.), (0.05, 600., CONTOUR), (0x4B3E35, 0x58493E)),
    row("crural", &[Crural], "trouser", 430, 0, (72., 56.), (27., 22.), (6., 5.), (0.06, 14.), (0.15, 500., CONTOUR), (0x4F4237, 0x6A5A4A)),
    row("tarsal", &[Tarsal], "tarsal", 300, 0, (34., 20.), (20., 14.), (7., 6.), (0.06, 14.), (0.05, 480., LESSER), (0x9A8369, 0x9A8369)),
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
            "body",
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
    look("secondaries", "secondary", 9, (0., 0.), (48., 47.), (0., 0.09, 10.), (12, 4), (0x2450AE, 0x2B6795)),
    look("tertials", "secondary", 3, (0., 0.), (46., 44.), (0., 0.08, 10.), (12, 4), (0x2D6C89, 0x2E6F86)),
    look("alula", "primary", 4, (45., 85.), (14., 20.), (3., 0.06, 8.), (6, 2), (0x1F46A6, 0x1F46A6)),
    look("primary_coverts", "greater", 10, (70., 110.), (24., 20.), (1.5, 0.07, 8.), (6, 2), (0x2450AE, 0x2450AE)),
    look("greater_coverts", "greater", 12, (98., 76.), (30., 36.), (5., 0.06, 10.), (6, 2), (0xF2BC14, 0xF2BC14)),
    look("median_primary", "greater", 9, (46., 34.), (24., 20.), (6., 0.06, 12.), (4, 2), (0x2A58AA, 0x2450AE)),
    look("median_secondary", "greater", 12, (62., 48.), (24., 30.), (6., 0.06, 12.), (4, 2), (0xF5C21A, 0xF5C21A)),
    look("under_primary", "greater", 10, (70., 95.), (28., 20.), (3., 0.06, 6.), (5, 2), (0xB0482A, 0xB0482A)),
    look("under_secondary", "greater", 12, (80., 55.), (24., 28.), (3., 0.06, 6.), (5, 2), (0xB0482A, 0xB0482A)),
    look("under_median_primary", "lesser", 10, (40., 28.), (20., 16.), (4., 0.06, 8.), (3, 2), (0xA8381F, 0xA8381F)),
    look("under_median_secondary", "lesser", 12, (45., 32.), (20., 22.), (4., 0.06, 8.), (3, 2), (0xA8381F, 0xA8381F)),
    look("axillaries", "soft", 9, (50., 80.), (20., 26.), (5., 0.05, 5.), (4, 2), (0xB03020, 0xB03020)),
    look("rectrices", "rectrix", 6, (0., 0.), (34., 30.), (0., 0.12, 4.), (18, 4), (0xB42A1C, 0xB0301E)),
];

/// Rows of the eagle.
#[rustfmt::skip]
pub const EAGLE_ROWS: &[RowLook] = &[
    look("primaries", "primary", 10, (0., 0.), (72., 42.), (0., 0.06, 4.), (16, 4), (0x312A26, 0x312A26)),
    look("secondaries", "secondary", 13, (0., 0.), (75., 68.), (0., 0.09, 12.), (12, 4), (0x39312C, 0x39312C)),
    look("tertials", "greater", 4, (0., 0.), (70., 62.), (0., 0.07, 30.), (12, 4), (0x41372F, 0x463B32)),
    look("alula", "primary", 4, (90., 170.), (26., 36.), (3., 0.06, 8.), (6, 2), (0x312A26, 0x312A26)),
    look("primary_coverts", "greater", 10, (130., 190.), (38., 32.), (1.5, 0.07, 8.), (6, 2), (0x382F29, 0x382F29)),
    look("greater_coverts", "greater", 14, (140., 105.), (44., 54.), (2., 0.06, 16.), (6, 2), (0x473C33, 0x473C33)),
    look("median_primary", "greater", 10, (80., 65.), (40., 34.), (6., 0.06, 12.), (4, 2), (0x54483D, 0x4E4238)),
    look("median_secondary", "greater", 15, (95., 70.), (38., 46.), (7., 0.06, 12.), (4, 2), (0x574A3F, 0x483D34)),
    look("under_primary", "greater", 10, (120., 150.), (46., 36.), (3., 0.06, 6.), (5, 2), (0x5B554E, 0x5B554E)),
    look("under_secondary", "greater", 14, (130., 95.), (40., 46.), (3., 0.06, 6.), (5, 2), (0x5B554E, 0x5B554E)),
    look("under_median_primary", "lesser", 11, (70., 55.), (34., 28.), (4., 0.06, 8.), (3, 2), (0x473D34, 0x473D34)),
    look("under_median_secondary", "lesser", 15, (80., 60.), (34., 36.), (4., 0.06, 8.), (3, 2), (0x473D34, 0x473D34)),
    look("axillaries", "soft", 14, (90., 150.), (34., 44.), (5., 0.05, 5.), (4, 2), (0x42382D, 0x42382D)),
    look("rectrices", "rectrix", 6, (0., 0.), (62., 58.), (0., 0.10, 4.), (12, 4), (0x4B4540, 0x4B4540)),
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
            feather: ["body", "soft"],
            tint: [0x675749, 0x705F4F],
        }
    }
}
