//! A feather or groom being edited: its history, its file, and what to compare it with. No app, no window.

use super::history::History;
use crate::{
    anatomy::Feather,
    asset::{RonAsset, write_whole},
    groom::Groom,
};
use std::{
    fs, io,
    path::{Path, PathBuf},
};
use thiserror::Error;

/// An asset that the inspector edits and keeps in a text file.
pub trait Editable: RonAsset + Clone + PartialEq {
    /// Takes over what files do not hold from another state of the same asset.
    fn keep_handles(&mut self, _other: &Self) {}
}

impl Editable for Feather {
    fn keep_handles(&mut self, other: &Self) {
        if self.albedo.image == other.albedo.image {
            self.image.clone_from(&other.image);
        }
    }
}

impl Editable for Groom {
    fn keep_handles(&mut self, other: &Self) {
        for link in &mut self.feathers {
            if let Some(known) = other.feathers.iter().find(|known| *known == link) {
                link.clone_from(known);
            }
        }
        let known = || {
            other
                .regions
                .iter()
                .filter_map(|region| region.down.as_ref())
        };
        for link in self.regions.iter_mut().filter_map(|r| r.down.as_mut()) {
            if let Some(known) = known().find(|known| *known == link) {
                link.clone_from(known);
            }
        }
    }
}

/// Why a document was not saved or loaded.
#[derive(Debug, Error)]
pub enum DocumentError {
    /// Somebody else has written the file since it was read; nothing was written.
    #[error("{0} has changed on disk since it was read")]
    Conflict(String),
    /// The file could not be read or written; what was there is still there.
    #[error("{0}: {1}")]
    Io(String, io::Error),
    /// What the file or the asset holds is not valid; nothing was changed.
    #[error("{0}")]
    Invalid(String),
}

/// One asset under edit.
#[derive(Clone, Debug)]
pub struct Document<T> {
    history: History<T>,
    /// The state last read or saved: what "before" means, and what unsaved is measured against.
    saved: T,
    file: Option<PathBuf>,
    /// Text of the file when it was last read or written.
    on_disk: Option<String>,
}

impl<T: Editable> Document<T> {
    /// Opens an asset that came from `file` (none: made in code).
    pub fn open(asset: T, file: Option<PathBuf>) -> Self {
        let on_disk = file
            .as_deref()
            .and_then(|path| fs::read_to_string(path).ok());
        Self {
            history: History::new(asset.clone()),
            saved: asset,
            file,
            on_disk,
        }
    }

    /// The present state.
    pub fn present(&self) -> &T {
        self.history.present()
    }

    /// The state last read or saved.
    pub fn saved(&self) -> &T {
        &self.saved
    }

    /// Whether the present state differs from the file.
    pub fn is_changed(&self) -> bool {
        self.present() != &self.saved
    }

    /// The file that saving writes.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Steps that can be undone and redone.
    pub fn depth(&self) -> (usize, usize) {
        self.history.depth()
    }

    /// Records an edit of the given gesture; the new state, if it is one.
    ///
    /// # Errors
    /// The first field that is out of range; nothing is recorded.
    pub fn edit(&mut self, value: T, gesture: u64) -> Result<Option<&T>, DocumentError> {
        value
            .validate(value.name())
            .map_err(|error| DocumentError::Invalid(error.to_string()))?;
        Ok(self
            .history
            .edit(value, gesture)
            .then(|| self.history.present()))
    }

    /// Steps back.
    pub fn undo(&mut self) -> Option<&T> {
        self.history.undo()
    }

    /// Steps forward.
    pub fn redo(&mut self) -> Option<&T> {
        self.history.redo()
    }

    /// The asset was loaded anew from its file: a step that can be undone, so that unsaved edits are not lost.
    pub fn reloaded(&mut self, value: T, gesture: u64) {
        if let Some(path) = &self.file {
            self.on_disk = fs::read_to_string(path).ok();
        }
        self.saved = value.clone();
        self.history.edit(value, gesture);
    }

    /// Whether the file no longer holds what was read from it or written to it.
    pub fn has_conflict(&self) -> bool {
        let Some(path) = &self.file else {
            return false;
        };
        match fs::read_to_string(path) {
            Ok(text) => self.on_disk.as_ref() != Some(&text),
            // A file that is gone takes nothing with it.
            Err(_) => false,
        }
    }

    /// Writes the present state to `file` (the document's own when `None`), whole or not at all.
    ///
    /// # Errors
    /// [`DocumentError::Conflict`] unless `overwrite`, if the file has changed since it was read; [`DocumentError::Io`].
    pub fn save(&mut self, file: Option<&Path>, overwrite: bool) -> Result<PathBuf, DocumentError> {
        let text = self
            .present()
            .to_ron()
            .map_err(|error| DocumentError::Invalid(error.to_string()))?;
        let Some(path) = file.map(Path::to_path_buf).or_else(|| self.file.clone()) else {
            return Err(DocumentError::Invalid("there is no file to save to".into()));
        };
        let name = path.display().to_string();
        let own = self.file.as_ref() == Some(&path);
        if !overwrite && ((own && self.has_conflict()) || (!own && path.exists())) {
            return Err(DocumentError::Conflict(name));
        }
        write_whole(&path, &text).map_err(|error| DocumentError::Io(name, error))?;
        self.saved = self.present().clone();
        self.on_disk = Some(text);
        self.file = Some(path.clone());
        Ok(path)
    }

    /// Reads a state from a file; a step that can be undone.
    ///
    /// # Errors
    /// What is wrong with the file; the document stays as it was.
    pub fn load(&mut self, file: &Path, gesture: u64) -> Result<&T, DocumentError> {
        let name = file.display().to_string();
        let text =
            fs::read_to_string(file).map_err(|error| DocumentError::Io(name.clone(), error))?;
        let mut value = T::from_ron(text.as_bytes(), &name)
            .map_err(|error| DocumentError::Invalid(error.to_string()))?;
        value.keep_handles(self.present());
        if self.file.as_deref() == Some(file) {
            self.on_disk = Some(text);
            self.saved = value.clone();
        }
        self.history.edit(value, gesture);
        Ok(self.history.present())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::anatomy;

    fn folder(name: &str) -> PathBuf {
        let folder =
            std::env::temp_dir().join(format!("bevy_plumage_{name}_{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    fn feather() -> Feather {
        anatomy::primary()
    }

    #[test]
    fn saves_and_reads_back() {
        let file = folder("save").join("a.feather.ron");
        let mut document = Document::open(feather(), None);
        let mut changed = feather();
        changed.left.barb_angle = 41.0;
        document.edit(changed.clone(), 1).unwrap();
        assert!(document.is_changed());
        document.save(Some(&file), false).unwrap();
        assert!(!document.is_changed());
        let text = fs::read_to_string(&file).unwrap();
        assert_eq!(Feather::from_ron(text.as_bytes(), "a").unwrap(), changed);
        // Nothing else is left in the folder.
        assert_eq!(fs::read_dir(file.parent().unwrap()).unwrap().count(), 1);
        fs::remove_dir_all(file.parent().unwrap()).unwrap();
    }

    #[test]
    fn a_changed_file_asks_first() {
        let file = folder("conflict").join("a.feather.ron");
        fs::write(&file, feather().to_ron().unwrap()).unwrap();
        let mut document = Document::open(feather(), Some(file.clone()));
        let mut mine = feather();
        mine.length_mm = 99.0;
        document.edit(mine.clone(), 1).unwrap();
        let mut theirs = feather();
        theirs.length_mm = 55.0;
        fs::write(&file, theirs.to_ron().unwrap()).unwrap();
        assert!(matches!(
            document.save(None, false),
            Err(DocumentError::Conflict(_))
        ));
        let kept = fs::read_to_string(&file).unwrap();
        assert_eq!(Feather::from_ron(kept.as_bytes(), "a").unwrap(), theirs);
        document.save(None, true).unwrap();
        let written = fs::read_to_string(&file).unwrap();
        assert_eq!(Feather::from_ron(written.as_bytes(), "a").unwrap(), mine);
        // Reading theirs back would have been a step that undo takes back.
        document.reloaded(theirs, 2);
        assert_eq!(document.undo(), Some(&mine));
        fs::remove_dir_all(file.parent().unwrap()).unwrap();
    }

    #[test]
    fn bad_input_changes_nothing() {
        let file = folder("bad").join("a.feather.ron");
        fs::write(&file, "(version: 1, name: \"broken\"").unwrap();
        let mut document = Document::open(feather(), None);
        let error = document.load(&file, 1).unwrap_err().to_string();
        assert!(error.contains("a.feather.ron:1:"), "{error}");
        let mut wild = feather();
        wild.left.barb_angle = 1e9;
        let error = document.edit(wild, 2).unwrap_err().to_string();
        assert!(
            error.contains("barb_angle") && error.contains("5 to 85"),
            "{error}"
        );
        assert_eq!(document.present(), &feather());
        assert_eq!(document.depth(), (0, 0));
        let nowhere = file.parent().unwrap().join("no/such/folder/a.feather.ron");
        assert!(matches!(
            document.save(Some(&nowhere), false),
            Err(DocumentError::Io(..))
        ));
        fs::remove_dir_all(file.parent().unwrap()).unwrap();
    }
}
