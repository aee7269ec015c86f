//! Outlines by type of feather, as half widths along it.

use super::template::Profile;

/// Broad and round, as on the body.
pub(super) const ROUND: Profile = Profile::new(
    &[(0.0, 0.4), (0.32, 0.8), (0.6, 1.0), (1.0, 0.97)],
    0.66,
    (2.1, 2.0),
);
/// Narrower and rounder, as on the head.
pub(super) const SCALE: Profile = Profile::new(
    &[(0.0, 0.6), (0.3, 0.9), (0.55, 1.0), (1.0, 0.9)],
    0.6,
    (2.0, 1.8),
);
/// Round with a flat end.
pub(super) const BLUNT: Profile = Profile::new(
    &[(0.0, 0.4), (0.32, 0.8), (0.66, 1.0), (1.0, 0.98)],
    0.72,
    (2.4, 2.0),
);
/// Widest near the end.
pub(super) const SPADE: Profile = Profile::new(
    &[(0.0, 0.3), (0.3, 0.66), (0.68, 1.0), (1.0, 0.98)],
    0.7,
    (2.3, 2.0),
);
/// Loose and rather pointed.
pub(super) const SOFT: Profile = Profile::new(
    &[(0.0, 0.5), (0.3, 0.86), (0.55, 1.0), (1.0, 0.8)],
    0.5,
    (1.9, 1.7),
);
/// Pointed, between a lance and the round feathers of the body.
pub(super) const LANCET: Profile = Profile::new(
    &[(0.0, 0.5), (0.28, 0.9), (0.48, 1.0), (1.0, 0.76)],
    0.46,
    (1.7, 1.3),
);
/// A tuft.
pub(super) const TUFT: Profile = Profile::new(
    &[(0.0, 0.75), (0.2, 1.0), (0.55, 1.0), (1.0, 0.7)],
    0.4,
    (2.0, 1.8),
);
/// Oblong with a round end, as the greater coverts.
pub(super) const OBLONG: Profile = Profile::new(
    &[(0.0, 0.3), (0.28, 0.76), (0.58, 1.0), (1.0, 0.97)],
    0.78,
    (2.2, 2.0),
);
/// Oblong with a fuller end: the trailing vane of a covert or secondary.
pub(super) const OBLONG_FULL: Profile = Profile::new(
    &[(0.0, 0.3), (0.28, 0.74), (0.58, 1.0), (1.0, 0.98)],
    0.84,
    (2.3, 2.0),
);
/// Lance of a hackle.
pub(super) const LANCEOLATE: Profile = Profile::new(
    &[(0.0, 0.65), (0.2, 0.95), (0.4, 1.0), (1.0, 0.62)],
    0.42,
    (1.7, 1.1),
);
/// Leading vane of a pointed, emarginated primary.
pub(super) const POINTED_LEADING: Profile = Profile::new(
    &[(0.0, 0.7), (0.2, 1.0), (0.44, 1.0), (0.6, 0.46), (1.0, 0.4)],
    0.82,
    (2.0, 1.4),
);
/// Trailing vane of a pointed primary.
pub(super) const POINTED_TRAILING: Profile = Profile::new(
    &[
        (0.0, 0.35),
        (0.14, 0.72),
        (0.34, 1.0),
        (0.5, 0.94),
        (0.75, 0.62),
        (1.0, 0.5),
    ],
    0.74,
    (1.8, 1.3),
);
/// Leading vane of a fingered primary: narrow beyond the emargination.
pub(super) const FINGER_LEADING: Profile = Profile::new(
    &[
        (0.0, 0.75),
        (0.15, 1.0),
        (0.42, 1.0),
        (0.51, 0.56),
        (1.0, 0.5),
    ],
    0.88,
    (2.0, 1.6),
);
/// Trailing vane of a fingered primary: the notch.
pub(super) const FINGER_TRAILING: Profile = Profile::new(
    &[
        (0.0, 0.6),
        (0.1, 0.9),
        (0.3, 1.0),
        (0.40, 0.97),
        (0.53, 0.42),
        (0.8, 0.4),
        (1.0, 0.36),
    ],
    0.84,
    (2.0, 1.7),
);
/// Leading vane of a plain remex.
pub(super) const REMEX_LEADING: Profile = Profile::new(
    &[(0.0, 0.7), (0.15, 1.0), (0.6, 0.96), (1.0, 0.85)],
    0.84,
    (2.0, 1.6),
);
/// Trailing vane of a plain remex.
pub(super) const REMEX_TRAILING: Profile = Profile::new(
    &[
        (0.0, 0.3),
        (0.2, 0.66),
        (0.42, 1.0),
        (0.75, 0.97),
        (1.0, 0.9),
    ],
    0.82,
    (2.1, 1.8),
);
/// A long lance, tapering over its last part.
pub(super) const LANCE: Profile = Profile::new(
    &[
        (0.0, 0.7),
        (0.1, 0.95),
        (0.3, 1.0),
        (0.55, 0.95),
        (0.8, 0.7),
        (1.0, 0.5),
    ],
    0.66,
    (1.6, 1.15),
);
/// Round-square end, as in a broad tail.
pub(super) const SQUARE: Profile = Profile::new(
    &[
        (0.0, 0.4),
        (0.16, 0.75),
        (0.42, 0.94),
        (0.8, 1.0),
        (1.0, 0.98),
    ],
    0.88,
    (2.6, 2.1),
);
/// Barbs only round the base of a bristle.
pub(super) const BRISTLE: Profile = Profile::new(
    &[(0.0, 1.0), (0.2, 0.7), (0.4, 0.15), (1.0, 0.05)],
    0.4,
    (1.5, 1.0),
);
/// A tuft at the end of a bare shaft.
pub(super) const BRUSH: Profile = Profile::new(
    &[(0.0, 0.0), (0.75, 0.4), (0.9, 1.0), (1.0, 0.9)],
    0.9,
    (2.0, 1.6),
);
