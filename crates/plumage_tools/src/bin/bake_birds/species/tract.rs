//! Tracts: the parts of the skin by what grows on them.

/// Number of a tract, as written to `TEXCOORD_1.x`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u32)]
pub enum Tract {
    Bare = 0,
    Crown = 1,
    Nape = 2,
    Cheek = 3,
    NeckDorsal = 4,
    NeckVentral = 5,
    Mantle = 6,
    Back = 7,
    Rump = 8,
    Breast = 9,
    Belly = 10,
    Flank = 11,
    Vent = 12,
    TailUpper = 13,
    TailUnder = 14,
    Femoral = 15,
    Crural = 16,
    Tarsal = 17,
    LesserUpper = 18,
    MarginalUpper = 19,
    CovertUpper = 20,
    LesserUnder = 21,
    MarginalUnder = 22,
    CovertUnder = 23,
    /// Mantle below the scapulars, which overlap it.
    ScapularMantle = 24,
    /// Side of the trunk below the folded wing.
    Side = 25,
    /// Skin round the lore and chin that carries bristles.
    Lore = 26,
    /// Naked skin on which nothing grows: round the eye, and along the rim of a naked face.
    EyeRing = 27,
    /// Upper side of the elbow, where no row of coverts stands.
    Elbow = 28,
    /// Facial disc, radial round the eye.
    Disc = 29,
    /// Rim of the facial disc.
    Ruff = 30,
    /// Over the folded humerus.
    Shoulder = 31,
}
