//! What masks painted into textures say of places on a skin.

use super::{
    error::MaskFlaw,
    mask_textures::{Channel, MaskValues, SkinTexture, channel_share},
    skin::{SkinMesh, SurfacePoint},
};
use bevy::{
    image::Image,
    math::{Vec2, Vec3},
};

/// Most places along each side of a triangle at which a texture is looked up to find its mean.
const MOST_PLACES: f32 = 8.0;

impl SkinMesh {
    /// With masks in textures. What cannot serve becomes a flaw and counts as no say.
    pub fn with_textures(mut self, textures: Vec<SkinTexture>) -> Self {
        for texture in textures {
            if let Some(flaw) = texture.unusable() {
                self.mask_flaws.push(flaw);
                continue;
            }
            self.mask_flaws.extend(texture.flat());
            let bare = self
                .without_uvs
                .iter()
                .map(|&mesh| MaskFlaw::NoCoordinates {
                    file: texture.name.clone(),
                    mesh,
                });
            self.mask_flaws.extend(bare);
            self.textures.push(texture);
        }
        self
    }

    fn density_textures(&self) -> impl Iterator<Item = &SkinTexture> {
        let density = |texture: &&SkinTexture| matches!(texture.sets, MaskValues::Density(..));
        self.textures.iter().filter(density)
    }

    /// Whether a texture says how many feathers grow where.
    pub(super) fn has_density_texture(&self) -> bool {
        self.density_textures().next().is_some()
    }

    /// Whether anything but the groom says how many feathers grow where.
    pub(super) fn has_density_mask(&self) -> bool {
        !self.masks.density.is_empty() || self.has_density_texture()
    }

    /// Texture coordinates of a point; `None` on a mesh without any.
    fn uv(&self, point: SurfacePoint) -> Option<Vec2> {
        if self.without_uvs.contains(&self.mesh_of(point.triangle)) {
            return None;
        }
        let corners = self.triangles[point.triangle as usize];
        let parts = corners.into_iter().zip(point.bary.to_array());
        Some(
            parts
                .map(|(vertex, share)| Vec2::from(self.uvs[vertex as usize]) * share)
                .sum(),
        )
    }

    /// What a picture says at a point, 0..1: 1 on a mesh without texture coordinates.
    pub(crate) fn picture_share(
        &self,
        image: &Image,
        channel: Channel,
        point: SurfacePoint,
    ) -> f32 {
        self.uv(point)
            .map_or(1.0, |uv| channel_share(image, channel, uv))
    }

    /// What the textures of a kind say at a point.
    pub(super) fn textured<'a>(
        &'a self,
        point: SurfacePoint,
        kind: fn(&MaskValues) -> bool,
    ) -> impl Iterator<Item = f32> + 'a {
        let mut textures = self
            .textures
            .iter()
            .filter(move |t| kind(&t.sets))
            .peekable();
        let uv = textures.peek().and_then(|_| self.uv(point));
        textures.filter_map(move |texture| Some(texture.sets.at(texture.share(uv?))))
    }

    /// Places of a triangle at which the number of its feathers is looked up: its middle, or as many as textures that say it have
    /// texels there, up to 64.
    pub(super) fn mask_places(&self, triangle: u32) -> Vec<SurfacePoint> {
        let at = |bary| SurfacePoint { triangle, bary };
        if !self.has_density_texture() {
            return vec![at(Vec3::splat(1.0 / 3.0))];
        }
        let texels = |texture: &SkinTexture| {
            let size = texture.image.size().as_vec2();
            let [a, b, c] = self.triangles[triangle as usize]
                .map(|vertex| Vec2::from(self.uvs[vertex as usize]) * size);
            0.5 * (b - a).perp_dot(c - a).abs()
        };
        let most = self.density_textures().map(texels).fold(1.0, f32::max);
        let side = most.sqrt().ceil().min(MOST_PLACES) as u32;
        // Middles of the `side` squared triangles that it is divided into.
        let third = 1.0 / (3.0 * side as f32);
        (0..side)
            .flat_map(|row| (0..2 * (side - row) - 1).map(move |column| (row, column)))
            .map(|(row, column)| {
                let turned = (column % 2) as f32;
                let y = (3 * (column / 2) + 1) as f32 + turned;
                let z = (3 * row + 1) as f32 + turned;
                at(Vec3::new(1.0 - (y + z) * third, y * third, z * third))
            })
            .collect()
    }
}
