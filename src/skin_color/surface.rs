//! The color of a place on the skin.

use crate::groom::{SkinMesh, SurfacePoint, address_modes, texel};
use bevy::{
    color::LinearRgba,
    image::{Image, TextureAccessError},
    math::{Affine2, Vec2, Vec3},
};

/// Most texels that are averaged along each side of a feather's square.
const MOST_TEXELS: f32 = 8.0;

/// What a mesh of the skin looks like.
#[derive(Clone, Debug)]
pub struct Surface<'a> {
    /// Linear base color.
    pub base: [f32; 3],
    /// Texture that it is multiplied by.
    pub texture: Option<&'a Image>,
    /// From texture coordinates to those of the texture.
    pub uv_transform: Affine2,
}

/// Linear color of the skin below a feather: vertex colors times base color times the mean of the texture over a square of side `size`
/// (metres) about the point. Surfaces are those of the skin's meshes in order; `None` where there is neither a surface nor a vertex color.
///
/// # Errors
/// [`TextureAccessError`] for a texture whose format cannot be read on the processor (compressed ones).
pub fn skin_color(
    skin: &SkinMesh,
    point: SurfacePoint,
    size: f32,
    surfaces: &[Option<Surface>],
) -> Result<Option<[f32; 3]>, TextureAccessError> {
    let surface = surfaces.get(skin.mesh_of(point.triangle));
    let surface = surface.and_then(Option::as_ref);
    if surface.is_none() && skin.colors.is_empty() {
        return Ok(None);
    }
    let corners = skin.triangles[point.triangle as usize].map(|vertex| vertex as usize);
    let weights = point.bary.to_array();
    let mut color = Vec3::ONE;
    if !skin.colors.is_empty() {
        let parts = corners.iter().zip(weights);
        color = parts.map(|(&v, w)| Vec3::from(skin.colors[v]) * w).sum();
    }
    if let Some(surface) = surface {
        color *= Vec3::from(surface.base);
        if let Some(image) = surface.texture {
            let [a, b, c] = corners.map(|v| {
                let uv = Vec2::from(skin.uvs[v]);
                surface.uv_transform.transform_point2(uv)
            });
            let uv = a * weights[0] + b * weights[1] + c * weights[2];
            // Side of the square in the texture: areas there over areas on the skin.
            let stretch = 0.5 * (b - a).perp_dot(c - a).abs() / skin.areas[point.triangle as usize];
            color *= texture_mean(image, uv, size * stretch.max(0.0).sqrt())?;
        }
    }
    // Not beyond what reflects all light, and a number whatever the file has.
    let sound = |x: f32| {
        if x.is_finite() {
            x.clamp(0.0, 1.0)
        } else {
            0.5
        }
    };
    Ok(Some(color.to_array().map(sound)))
}

/// Linear mean of the texture over a square about `uv`, in texture coordinates.
fn texture_mean(image: &Image, uv: Vec2, side: f32) -> Result<Vec3, TextureAccessError> {
    let size = image.size();
    let across = (side * size.max_element() as f32).ceil();
    let count = across.clamp(1.0, MOST_TEXELS) as u32;
    let [wrap_u, wrap_v] = address_modes(image);
    let mut sum = Vec3::ZERO;
    for i in 0..count * count {
        let cell = Vec2::new((i % count) as f32, (i / count) as f32);
        let at = uv + side * ((cell + 0.5) / count as f32 - 0.5);
        let x = texel(at.x, size.x, wrap_u);
        let y = texel(at.y, size.y, wrap_v);
        let LinearRgba {
            red, green, blue, ..
        } = image.get_color_at(x, y)?.to_linear();
        sum += Vec3::new(red, green, blue);
    }
    Ok(sum / (count * count) as f32)
}
