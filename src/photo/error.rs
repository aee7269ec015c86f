//! Why no feather came out of a photograph.

use super::PhotoObject;
use crate::asset::AssetError;
use thiserror::Error;

/// So many objects are named in a message.
const NAMED: usize = 8;

/// Numbers and places of objects.
fn list(objects: &[PhotoObject]) -> String {
    let mut text: Vec<String> = objects
        .iter()
        .take(NAMED)
        .enumerate()
        .map(|(i, object)| format!("{} {object}", i + 1))
        .collect();
    if objects.len() > NAMED {
        text.push(format!("and {} more", objects.len() - NAMED));
    }
    text.join(", ")
}

/// Why a photograph was refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ExtractError {
    /// The file could not be read or written.
    #[error("{file}: {message}")]
    Io {
        /// File name.
        file: String,
        /// What the operating system said.
        message: String,
    },
    /// Not a picture in a known format (PNG, JPEG, WebP), or a damaged one. The content counts, not the extension.
    #[error("{file}: not a readable PNG, JPEG or WebP: {message}")]
    Decode {
        /// File name.
        file: String,
        /// What the decoder said.
        message: String,
    },
    /// More bytes than a photograph may have.
    #[error("{file}: {bytes} bytes, a photograph has at most {limit}")]
    TooManyBytes {
        /// File name.
        file: String,
        /// Size found.
        bytes: u64,
        /// Size allowed.
        limit: u64,
    },
    /// Too small to see a feather in, or too large to hold.
    #[error(
        "the photograph has {width} x {height} pixels, allowed are {low} to {high} a side and {pixels} in all"
    )]
    Size {
        /// Width found.
        width: u32,
        /// Height found.
        height: u32,
        /// Least side.
        low: u32,
        /// Largest side.
        high: u32,
        /// Most pixels.
        pixels: u64,
    },
    /// A setting outside its range.
    #[error("setting `{field}` is {value}, allowed is {low} to {high}")]
    Setting {
        /// Name of the setting.
        field: &'static str,
        /// Value found.
        value: f64,
        /// Least value.
        low: f64,
        /// Largest value.
        high: f64,
    },
    /// A name that is no file name.
    #[error("the name {name:?} has a path separator or starts with a dot")]
    Name {
        /// Name found.
        name: String,
    },
    /// Nothing stands out from the background, or nothing that could be a feather.
    #[error("no feather found: {reason}")]
    NoFeather {
        /// What was seen instead.
        reason: String,
    },
    /// The ground is rough (a wall of rock, grass, gravel), and what stands out of it is not surely a feather. What reaches the
    /// picture's border as one thing, as a hand does, has no contrast here.
    #[error(
        "the ground is too rough to tell a feather from it: its noise is {noise:.2} in lightness (up to {even:.2} is even), and the {measure} of what stands out is {value:.2}, allowed is {least:.2} to 1; photograph the feather against something plainer or of another color"
    )]
    RoughGround {
        /// Noise of the ground, in Oklab's lightness.
        noise: f32,
        /// Most noise of a ground that is even.
        even: f32,
        /// What was too low: the contrast of color (how much of what is feather and what ground the colors tell, 0..1), or the
        /// confidence ([`Confidence::overall`](super::Confidence::overall)).
        measure: &'static str,
        /// Value found.
        value: f32,
        /// Least value.
        least: f32,
    },
    /// A hand, or something else that reaches the picture's border, touches the feather, and its colors are too much like the
    /// feather's to tell where it ends.
    #[error(
        "what holds the feather touches it, reaches the picture's border and is told from it by color to {apart:.2} only, at least {least:.2} is needed; lay the feather down, or hold it with something of another color"
    )]
    Held {
        /// How much of what is feather and what holds it the colors tell, 0..1.
        apart: f32,
        /// Least difference allowed.
        least: f32,
    },
    /// More than one object of comparable size, and none was chosen (`ExtractSettings::object`).
    #[error("{} objects of comparable size: {}; choose one, or crop the photograph to it", objects.len(), list(objects))]
    SeveralObjects {
        /// All of them, from left to right, as `ObjectChoice::Number` counts them.
        objects: Vec<PhotoObject>,
    },
    /// The object chosen is not there.
    #[error("no object {asked}; {}: {}", match objects.len() { 1 => "there is 1".to_owned(), n => format!("there are {n}") }, list(objects))]
    NoSuchObject {
        /// What was chosen.
        asked: String,
        /// What is there.
        objects: Vec<PhotoObject>,
    },
    /// The asset that came out is not valid.
    #[error(transparent)]
    Feather(#[from] AssetError),
}
