//! What a table of feathers says: tracts, rows, tail coverts.

use super::tract::Tract::{self, *};

/// The part of a wing that a tract is cut down to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limb {
    /// No cut.
    Whole,
    /// What the digit does not carry: arm, wrist and palm.
    Arm,
    /// What the digit carries: the outer hand.
    Digit,
}

/// One scattered tract. Spans run over phi, cranial to caudal.
#[derive(Debug)]
pub struct TractRow {
    /// Name.
    pub name: &'static str,
    /// Tracts of the mesh it grows on.
    pub on: &'static [Tract],
    /// Part of them.
    pub limb: Limb,
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
    /// How much the values of two feathers differ, share.
    pub variety: f32,
}

impl TractRow {
    /// The same with feathers that differ by another share; usual is 0.03: coats run together, they are not scaled.
    pub const fn varied(self, variety: f32) -> Self {
        Self { variety, ..self }
    }

    /// The same on one part of the wing.
    pub const fn of(self, limb: Limb) -> Self {
        Self { limb, ..self }
    }
}

/// A row of a table of tracts, in the order of [`TractRow`]'s fields.
pub const fn row(
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
        limb: Limb::Whole,
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
        variety: 0.03,
    }
}

/// All that a filler grows on.
pub const TRUNK: &[Tract] = &[
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
/// Segments of small feathers.
pub const HEAD: (u8, u8) = (2, 2);
/// Segments of body feathers.
pub const CONTOUR: (u8, u8) = (4, 2);
/// Segments of small coverts.
pub const LESSER: (u8, u8) = (3, 2);

/// One kind of flight-feather row: lengths along the row, width, lift, camber, curl, color.
#[derive(Debug)]
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

/// A row of a table of rows, in the order of [`RowLook`]'s fields.
pub const fn look(
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

/// Tail coverts: feathers of one side per row (caudal row first) above and below, lengths caudal to cranial, widths, colors.
#[derive(Clone, Copy, Debug)]
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

/// Lengths that change evenly along a row.
pub fn ramp(a: f32, b: f32, n: usize) -> impl Iterator<Item = f32> {
    (0..n).map(move |i| a + (b - a) * i as f32 / (n - 1) as f32)
}
