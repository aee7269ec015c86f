//! Reading a photograph in bounded memory.

use super::ExtractError;
use image::{DynamicImage, ImageDecoder, ImageReader, Limits, metadata::Orientation};
use std::{
    io::{BufRead, Cursor, Seek},
    path::Path,
};

/// Most bytes of a photograph's file.
pub const MAX_FILE_BYTES: u64 = 256 << 20;
/// Most pixels of a photograph.
pub const MAX_PIXELS: u64 = 120_000_000;
/// Longest side of a photograph in pixels.
pub const MAX_SIDE: u32 = 32_768;
/// Shortest side of a photograph in pixels.
pub const MIN_SIDE: u32 = 24;

pub(super) fn check_size(width: u32, height: u32) -> Result<(), ExtractError> {
    let low = width.min(height) >= MIN_SIDE;
    let high = width.max(height) <= MAX_SIDE;
    if low && high && u64::from(width) * u64::from(height) <= MAX_PIXELS {
        return Ok(());
    }
    Err(ExtractError::Size {
        width,
        height,
        low: MIN_SIDE,
        high: MAX_SIDE,
        pixels: MAX_PIXELS,
    })
}

/// Reads a PNG, JPEG or WebP, whatever its extension says, and turns it upright as its camera noted.
pub fn load_photograph(path: impl AsRef<Path>) -> Result<DynamicImage, ExtractError> {
    let path = path.as_ref();
    let file = path.display().to_string();
    let failed = |error: std::io::Error| ExtractError::Io {
        file: file.clone(),
        message: error.to_string(),
    };
    let opened = std::fs::File::open(path).map_err(failed)?;
    let bytes = opened.metadata().map_err(failed)?.len();
    check_bytes(bytes, &file)?;
    decode(std::io::BufReader::new(opened), &file)
}

/// Decodes the bytes of a photograph; `name` is only for messages.
pub fn decode_photograph(bytes: &[u8], name: &str) -> Result<DynamicImage, ExtractError> {
    check_bytes(bytes.len() as u64, name)?;
    decode(Cursor::new(bytes), name)
}

fn check_bytes(bytes: u64, name: &str) -> Result<(), ExtractError> {
    if bytes <= MAX_FILE_BYTES {
        return Ok(());
    }
    Err(ExtractError::TooManyBytes {
        file: name.to_owned(),
        bytes,
        limit: MAX_FILE_BYTES,
    })
}

fn decode(source: impl BufRead + Seek, name: &str) -> Result<DynamicImage, ExtractError> {
    let failed = |message: String| ExtractError::Decode {
        file: name.to_owned(),
        message,
    };
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_PIXELS * 8);
    let mut reader = ImageReader::new(source)
        .with_guessed_format()
        .map_err(|error| failed(error.to_string()))?;
    if reader.format().is_none() {
        return Err(failed("unknown format".to_owned()));
    }
    reader.limits(limits.clone());
    let mut decoder = reader
        .into_decoder()
        .map_err(|error| failed(error.to_string()))?;
    let (width, height) = decoder.dimensions();
    // Before the pixels are decoded: a small file can claim a huge picture.
    check_size(width, height)?;
    decoder
        .set_limits(limits)
        .map_err(|error| failed(error.to_string()))?;
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    let mut image =
        DynamicImage::from_decoder(decoder).map_err(|error| failed(error.to_string()))?;
    image.apply_orientation(orientation);
    Ok(image)
}
