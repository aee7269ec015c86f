//! Where the parts of a feather stand in the buffer `feathers` (`feather_data.wgsl`).

use crate::{
    anatomy::{CONTOUR_ROWS, RACHIS_ROWS},
    maths::scattering::{KEPT_AZIMUTHS, KEPT_LEVELS, SHEEN_TABLE_SIZE},
};

/// vec4s of a feather's header.
pub const HEADER_LENGTH: usize = 48;
/// Where the parts of a feather's header begin, in vec4s.
pub mod header {
    /// Aspect, length in metres, root of the lowest barb, 1: a dark back.
    pub const SHAPE: usize = 0;
    /// Five: sine and cosine of the angles of barbs and barbules; p_b, d_bl, r_b, r_bd; r_bp, fringe, downy, kappa; and of
    /// [`VaneShape`](crate::maths::query::VaneShape) e_root, one over both periods, barb; radii of the families, one over both.
    pub const LEFT_VANE: usize = 1;
    /// Likewise.
    pub const RIGHT_VANE: usize = 6;
    /// Strength and roughness; place of the thin layers in the buffer, 0: none.
    pub const SHEEN: usize = 11;
    /// Parameters of the four fibres, `FIBRE_PARAMETER_VEC4S` each: rachis, barb, distal, proximal.
    pub const FIBRES: usize = 12;
    /// Four, of the same: factor on the painted color; the chance that light meets another fibre, seen from front and back; fibre table.
    pub const PARTS: usize = 40;
    /// One over the integral over the sphere of what the vanes catch.
    pub const CAUGHT: usize = 44;
    /// Where mirror lobes leave barbs and barbules: azimuthal roughness, share of the way from the normal half way; both twice.
    pub const MIRRORS: usize = 45;
    /// Two, barbs and the barbules that the eye meets first: the darkest painted color by which they differ, seen from the front and from the
    /// back (below, nothing shows of a fibre but its surface, [`shown_albedo`](crate::maths::scattering::shown_albedo)); the palest; 1 for
    /// structural fibres.
    pub const PAINT: usize = 46;
}
/// vec4s of one feather.
pub const FEATHER_STRIDE: usize = HEADER_LENGTH
    + RACHIS_ROWS
    + CONTOUR_ROWS
    + SHEEN_TABLE_SIZE
    + 16 * KEPT_LEVELS * KEPT_AZIMUTHS;
