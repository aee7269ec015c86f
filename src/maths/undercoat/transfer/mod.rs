//! Precomputed radiance transfer of a tile: how much of the light from every direction reaches each cell
//! (docs/book/undercoat.md#transfer).
//!
//! [`bake()`] traces rays from every cell and keeps the transfer as 25 harmonics; [`Transfer::compress`] reduces them to four numbers: the
//! open share of the sphere and the bent vector, from which bands 2 to 4 are predicted as zonal harmonics about the bent vector.
//! Those rotate with the skin by one matrix. [`transfer_zonal`] lights a cell by an environment, [`transfer_towards`] by one
//! direction; both are twins of `down_transfer.wgsl`.

mod bake;
mod four;
mod light;
mod pack;

pub use bake::{Baker, RawTransfer, Rays, Skin, TransferError, TransferSettings, bake, rays};
pub use four::{
    BANDS_VEC4S, FOUR_FIT, Four, Transfer, TransferBands, transfer_bands, transfer_raw,
    transfer_rotate, transfer_towards, transfer_zonal, transfer_zonal_full,
};
pub use light::{Sky, equirect_sky, sample_sky, sky};
pub use pack::{Mip, transfer_decode, transfer_texture};
