//! [`RonAsset`]: an asset that is kept as RON text.

use super::{AssetError, check};
use bevy::{
    asset::{Asset, LoadContext},
    reflect::PartialReflect,
};
use ron::error::SpannedError;
use serde::{
    Deserializer as _, Serialize,
    de::{DeserializeOwned, IgnoredAny, MapAccess, Visitor},
};
use std::{
    fmt, fs,
    io::{self, Write as _},
    path::Path,
};

/// An asset that is kept as RON text in a file with a version.
///
/// Every number is checked against the [`Parameter`](crate::parameter::Parameter) of its field and every list against its
/// [`Length`](crate::parameter::Length); only what several fields must fulfil together is written by hand ([`RonAsset::check_relations`]).
pub trait RonAsset: Asset + PartialReflect + Serialize + DeserializeOwned {
    /// Name of the type, as a file may write it before the opening bracket.
    const NAME: &'static str;
    /// What its files end in, e.g. `feather.ron`.
    const EXTENSION: &'static str;
    /// Version that is written.
    const VERSION: u32;
    /// Oldest version that is read.
    const OLDEST: u32 = Self::VERSION;
    /// Largest file that is read or written, in bytes.
    const MAX_BYTES: usize = 4 << 20;
    /// Structures nested deeper than this stand on one line of the file.
    const LINES_TO_DEPTH: usize = 3;

    /// The version that the value says it has.
    fn version(&self) -> u32;

    /// Name shown to people.
    fn name(&self) -> &str;

    /// Reads a file of an older version, [`RonAsset::OLDEST`] or later; `file` is for messages.
    ///
    /// # Errors
    /// [`AssetError::Syntax`].
    fn migrate(_version: u32, bytes: &[u8], file: &str) -> Result<Self, AssetError> {
        parse(bytes, file)
    }

    /// Checks what the ranges of single fields do not say. The fields are checked already.
    ///
    /// # Errors
    /// [`AssetError::Value`]; its file is filled in by the caller.
    fn check_relations(&self) -> Result<(), AssetError> {
        Ok(())
    }

    /// Starts to load the assets that the file names, so that they are its dependencies.
    ///
    /// # Errors
    /// [`AssetError::Value`] for a name that is no asset path; its file is filled in by the caller.
    fn load_dependencies(&mut self, _context: &mut LoadContext<'_>) -> Result<(), AssetError> {
        Ok(())
    }

    /// Reads and checks the text of a file; `file` is for messages.
    ///
    /// # Errors
    /// [`AssetError::TooLarge`], [`AssetError::Version`], [`AssetError::Syntax`] with line and column, or
    /// [`AssetError::Value`].
    fn from_ron(bytes: &[u8], file: &str) -> Result<Self, AssetError> {
        check_bytes::<Self>(bytes.len(), file)?;
        // The version comes first, so that a file of another version is not called malformed.
        let asset = match version_of(bytes, Self::NAME) {
            Some(version) if version != Self::VERSION => {
                check_version::<Self>(version, Self::OLDEST).map_err(|e| e.in_file(file))?;
                Self::migrate(version, bytes, file)?
            }
            _ => parse(bytes, file)?,
        };
        asset.validate(file)?;
        Ok(asset)
    }

    /// The text of a file that [`RonAsset::from_ron`] reads back to the same value.
    ///
    /// # Errors
    /// [`AssetError::Value`] for an asset that could not be read back, [`AssetError::TooLarge`], [`AssetError::Write`]. The
    /// error's file is the asset's name.
    fn to_ron(&self) -> Result<String, AssetError> {
        self.validate(self.name())?;
        let style = ron::ser::PrettyConfig::new()
            .new_line("\n")
            .compact_arrays(true)
            .depth_limit(Self::LINES_TO_DEPTH);
        let mut text =
            ron::ser::to_string_pretty(self, style).map_err(|error| AssetError::Write {
                file: self.name().to_owned(),
                message: error.to_string(),
            })?;
        text.push('\n');
        check_bytes::<Self>(text.len(), self.name())?;
        Ok(text)
    }

    /// Checks every value against the range documented at its field; `file` is for messages.
    ///
    /// # Errors
    /// [`AssetError::Version`], or [`AssetError::Value`] for the first field that is out of range.
    fn validate(&self, file: &str) -> Result<(), AssetError> {
        check_version::<Self>(self.version(), Self::VERSION)
            .and_then(|()| check::check(self))
            .and_then(|()| self.check_relations())
            .map_err(|error| error.in_file(file))
    }

    /// Writes the asset to a file. A reader never sees half of it: the text goes to a file beside it that then takes its
    /// place. On failure the old file stays.
    ///
    /// # Errors
    /// Those of [`RonAsset::to_ron`], or [`AssetError::Write`].
    fn write(&self, path: &Path) -> Result<(), AssetError> {
        let file = path.display().to_string();
        let text = self.to_ron().map_err(|error| error.in_file(&file))?;
        write_whole(path, &text).map_err(|error| AssetError::Write {
            file,
            message: error.to_string(),
        })
    }
}

/// Parses the text of a file into one version of its structure.
pub(crate) fn parse<T: DeserializeOwned>(bytes: &[u8], file: &str) -> Result<T, AssetError> {
    ron::de::from_bytes(bytes).map_err(|error: SpannedError| AssetError::Syntax {
        file: file.to_owned(),
        line: error.span.start.line,
        column: error.span.start.col,
        message: error.code.to_string(),
    })
}

/// Writes beside the file and renames, so that a crash leaves the old file or the new one.
pub(crate) fn write_whole(path: &Path, text: &str) -> io::Result<()> {
    let mut beside = path.as_os_str().to_owned();
    beside.push(format!(".{}.part", std::process::id()));
    let written = fs::File::create(&beside)
        .and_then(|mut file| {
            file.write_all(text.as_bytes())
                .and_then(|()| file.sync_all())
        })
        .and_then(|()| fs::rename(&beside, path));
    if written.is_err() {
        // A leftover that cannot be removed either is nothing to add to the first error.
        let _ = fs::remove_file(&beside);
    }
    written
}

fn check_bytes<A: RonAsset>(bytes: usize, file: &str) -> Result<(), AssetError> {
    if bytes <= A::MAX_BYTES {
        return Ok(());
    }
    Err(AssetError::TooLarge {
        file: file.to_owned(),
        bytes,
        limit: A::MAX_BYTES,
    })
}

fn check_version<A: RonAsset>(found: u32, oldest: u32) -> Result<(), AssetError> {
    let hint = if found > A::VERSION {
        "written by a newer bevy_plumage: update the crate"
    } else if found < oldest {
        "too old: write it anew"
    } else {
        return Ok(());
    };
    Err(AssetError::Version {
        file: String::new(),
        found,
        oldest: A::OLDEST,
        newest: A::VERSION,
        hint,
    })
}

/// The `version` field of a file, whatever its other fields are; `None` if it has none or is no such file.
fn version_of(bytes: &[u8], name: &'static str) -> Option<u32> {
    let mut deserializer = ron::Deserializer::from_bytes(bytes).ok()?;
    let mut version = None;
    // What follows the version is not read, and missed by the deserializer: its error says nothing.
    let _ = deserializer.deserialize_struct(name, &["version"], VersionField(&mut version));
    version
}

/// Keeps the version that it meets.
struct VersionField<'a>(&'a mut Option<u32>);

impl<'de> Visitor<'de> for VersionField<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a structure")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut fields: A) -> Result<(), A::Error> {
        while let Some(name) = fields.next_key::<String>()? {
            if name == "version" {
                *self.0 = Some(fields.next_value()?);
                return Ok(());
            }
            fields.next_value::<IgnoredAny>()?;
        }
        Ok(())
    }
}
