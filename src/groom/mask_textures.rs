//! Masks painted into textures: number, length and lift of the feathers where the skin's texture coordinates fall.

use super::error::MaskFlaw;
use crate::{asset::AssetLink, parameter::Parameter};
use bevy::{
    asset::{UntypedAssetId, VisitAssetDependencies},
    color::Color,
    ecs::prelude::*,
    image::{Image, ImageAddressMode, ImageSampler},
    math::Vec2,
    reflect::{Reflect, std_traits::ReflectDefault},
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Places along each side of a texture at which it is looked at to see whether it says anything.
const LOOKED_AT: u32 = 64;

/// A channel of a texture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect, Serialize, Deserialize)]
pub enum Channel {
    /// The first; of a gray picture it is all there is.
    #[default]
    Red,
    /// The second.
    Green,
    /// The third.
    Blue,
    /// The fourth.
    Alpha,
}

/// What a mask says, at the channel's 0 and at its full value; between them in proportion.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
pub enum MaskValues {
    /// Factor on the number of feathers, 0..4; none grow below 0.01.
    Density(
        #[reflect(@Parameter::new("", 0.0, 4.0))] f32,
        #[reflect(@Parameter::new("", 0.0, 4.0))] f32,
    ),
    /// Factor on their length and width, 0.05..4.
    Length(
        #[reflect(@Parameter::new("", 0.05, 4.0))] f32,
        #[reflect(@Parameter::new("", 0.05, 4.0))] f32,
    ),
    /// Degrees added to their lift, -90..90.
    Lift(
        #[reflect(@Parameter::degrees(-90.0, 90.0))] f32,
        #[reflect(@Parameter::degrees(-90.0, 90.0))] f32,
    ),
}

impl Default for MaskValues {
    fn default() -> Self {
        Self::Density(0.0, 1.0)
    }
}

impl MaskValues {
    pub(super) fn at(self, share: f32) -> f32 {
        let (Self::Density(low, high) | Self::Length(low, high) | Self::Lift(low, high)) = self;
        low + (high - low) * share
    }
}

/// A mask in a channel of a texture, laid over the skin by its texture coordinates (`TEXCOORD_0`, without the material's transform)
/// and looked up where a feather is rooted. The channel's numbers count as the file has them, also those of an sRGB picture. Several
/// masks of one kind multiply (lifts add up), with those of the vertices ([`SkinMasks`](super::SkinMasks)) too.
#[derive(Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct MaskTexture {
    /// The texture.
    pub texture: AssetLink<Image>,
    /// Its channel.
    #[serde(default)]
    pub channel: Channel,
    /// What it says.
    pub sets: MaskValues,
}

impl MaskTexture {
    /// What the red channel of a texture says.
    pub fn new(texture: impl Into<AssetLink<Image>>, sets: MaskValues) -> Self {
        Self {
            texture: texture.into(),
            channel: Channel::Red,
            sets,
        }
    }

    /// In another channel.
    pub fn with_channel(mut self, channel: Channel) -> Self {
        self.channel = channel;
        self
    }
}

impl VisitAssetDependencies for MaskTexture {
    fn visit_dependencies(&self, visit: &mut impl FnMut(UntypedAssetId)) {
        self.texture.visit_dependencies(visit);
    }
}

/// Masks of a bird besides those of its groom: on the entity with the [`Plumage`](super::Plumage). Paths are relative to the root of
/// the assets. Read when the feathers grow; they grow anew when a texture changes.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct PlumageMasks(pub Vec<MaskTexture>);

/// A mask whose texture is there.
#[derive(Clone, Debug)]
pub struct SkinTexture {
    /// Its name in messages.
    pub name: String,
    /// The texture.
    pub image: Arc<Image>,
    /// The channel that counts.
    pub channel: Channel,
    /// What it says.
    pub sets: MaskValues,
}

/// A channel of a texel as it is stored, 0..1; `None` where it cannot be read.
fn stored(image: &Image, channel: Channel, x: u32, y: u32) -> Option<f32> {
    let value = match image.get_color_at(x, y).ok()? {
        Color::Srgba(color) => [color.red, color.green, color.blue, color.alpha],
        color => {
            let color = color.to_linear();
            [color.red, color.green, color.blue, color.alpha]
        }
    }[channel as usize];
    Some(if value.is_finite() {
        value.clamp(0.0, 1.0)
    } else {
        0.0
    })
}

/// How a texture goes on beyond its edges; repeated unless it says something else, as in glTF.
pub(crate) fn address_modes(image: &Image) -> [ImageAddressMode; 2] {
    match &image.sampler {
        ImageSampler::Descriptor(sampler) => [sampler.address_mode_u, sampler.address_mode_v],
        ImageSampler::Default => [ImageAddressMode::Repeat; 2],
    }
}

/// The texel that a coordinate falls on.
pub(crate) fn texel(at: f32, size: u32, mode: ImageAddressMode) -> u32 {
    let at = if at.is_finite() { at } else { 0.0 };
    let inside = match mode {
        ImageAddressMode::Repeat => at.rem_euclid(1.0),
        ImageAddressMode::MirrorRepeat => 1.0 - (at.rem_euclid(2.0) - 1.0).abs(),
        ImageAddressMode::ClampToEdge | ImageAddressMode::ClampToBorder => at.clamp(0.0, 1.0),
    };
    ((inside * size as f32) as u32).min(size.saturating_sub(1))
}

impl SkinTexture {
    /// What is wrong with it, if it cannot serve at all.
    pub(super) fn unusable(&self) -> Option<MaskFlaw> {
        let (file, channel) = (self.name.clone(), self.channel);
        let format = self.image.texture_descriptor.format;
        if stored(&self.image, channel, 0, 0).is_none() {
            let format = format!("{format:?}");
            return Some(MaskFlaw::Unreadable { file, format });
        }
        if channel as u8 >= format.components() {
            let channels = format.components();
            return Some(MaskFlaw::NoChannel {
                file,
                channel,
                channels,
            });
        }
        None
    }

    /// Whether it says one and the same everywhere, which is seldom meant (the alpha of a picture without any).
    pub(super) fn flat(&self) -> Option<MaskFlaw> {
        let size = self.image.size();
        let looked_at = |i: u32, side: u32| (i * side / LOOKED_AT).min(side.saturating_sub(1));
        let mut values = (0..LOOKED_AT * LOOKED_AT).filter_map(|i| {
            let (x, y) = (
                looked_at(i % LOOKED_AT, size.x),
                looked_at(i / LOOKED_AT, size.y),
            );
            stored(&self.image, self.channel, x, y)
        });
        let first = values.next()?;
        values.all(|value| value == first).then(|| MaskFlaw::Flat {
            file: self.name.clone(),
            channel: self.channel,
            value: first,
        })
    }

    /// The channel between texels, 0..1.
    pub(super) fn share(&self, uv: Vec2) -> f32 {
        channel_share(&self.image, self.channel, uv)
    }
}

/// A channel of a picture between texels, 0..1; 1 where it cannot be read.
pub(super) fn channel_share(image: &Image, channel: Channel, uv: Vec2) -> f32 {
    let size = image.size();
    let [u, v] = address_modes(image);
    let place = uv * size.as_vec2() - 0.5;
    let low = place.floor();
    let part = place - low;
    let at = |dx: f32, dy: f32| {
        let centre = (low + Vec2::new(dx, dy) + 0.5) / size.as_vec2();
        let (x, y) = (texel(centre.x, size.x, u), texel(centre.y, size.y, v));
        stored(image, channel, x, y).unwrap_or(1.0)
    };
    let top = at(0.0, 0.0) * (1.0 - part.x) + at(1.0, 0.0) * part.x;
    let bottom = at(0.0, 1.0) * (1.0 - part.x) + at(1.0, 1.0) * part.x;
    let share = top * (1.0 - part.y) + bottom * part.y;
    if share.is_finite() { share } else { 0.0 }
}
