//! What is open: documents of feathers and grooms, and what commands do to them.

use super::{
    command::Command,
    document::{Document, DocumentError, Editable},
    panels::Toolbar,
};
use bevy::{
    asset::{Asset, AssetId},
    platform::collections::HashMap,
};
use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

/// How long a list of files is good for.
const LIST_AGE: Duration = Duration::from_secs(1);

/// Documents of one kind of asset.
#[derive(Debug)]
pub struct Session<A: Asset> {
    documents: HashMap<AssetId<A>, Document<A>>,
    /// When the files of which folder were listed.
    listed: Option<(Instant, PathBuf)>,
    /// The document that the bar stands above.
    barred: Option<AssetId<A>>,
    /// The bar above the panel.
    pub toolbar: Toolbar,
}

impl<A: Asset> Default for Session<A> {
    fn default() -> Self {
        Self {
            documents: HashMap::default(),
            listed: None,
            barred: None,
            toolbar: Toolbar::default(),
        }
    }
}

impl<A: Asset + Editable> Session<A> {
    /// The document of an asset, opened if it is not yet.
    pub fn document(
        &mut self,
        id: AssetId<A>,
        asset: &A,
        file: impl FnOnce() -> Option<PathBuf>,
    ) -> &mut Document<A> {
        self.documents
            .entry(id)
            .or_insert_with(|| Document::open(asset.clone(), file()))
    }

    /// The document of an asset, if it is open.
    pub fn get(&self, id: AssetId<A>) -> Option<&Document<A>> {
        self.documents.get(&id)
    }

    /// A document that is open, and the bar to draw above it; what the bar said of another document goes.
    pub fn parts(&mut self, id: AssetId<A>) -> Option<(&Document<A>, &mut Toolbar)> {
        if self.barred != Some(id) {
            self.barred = Some(id);
            self.toolbar.message = None;
            self.toolbar.asking = false;
            self.toolbar.comparing = false;
        }
        Some((self.documents.get(&id)?, &mut self.toolbar))
    }

    /// Keeps the list of files to load from up to date.
    pub fn list(&mut self, folder: &Path) {
        let fresh = self
            .listed
            .as_ref()
            .is_some_and(|(at, of)| of == folder && at.elapsed() < LIST_AGE);
        if !fresh {
            self.toolbar.files = files(folder, A::EXTENSION);
            self.listed = Some((Instant::now(), folder.to_path_buf()));
        }
    }

    /// Takes an edit in. The error is shown in the bar and nothing changes.
    pub fn edit(&mut self, id: AssetId<A>, value: A, gesture: u64) {
        let Some(document) = self.documents.get_mut(&id) else {
            return;
        };
        self.toolbar.comparing = false;
        self.toolbar.message = document
            .edit(value, gesture)
            .err()
            .map(|error| Err(error.to_string()));
    }

    /// The asset has changed: if from outside (its file was written), it is a step in the history; whether it was.
    pub fn changed_outside(&mut self, id: AssetId<A>, value: &A, gesture: u64) -> bool {
        let Some(document) = self.documents.get_mut(&id) else {
            return false;
        };
        let outside = document.present() != value && document.saved() != value;
        if outside {
            document.reloaded(value.clone(), gesture);
            self.toolbar.message = Some(Ok("Loaded anew: the file has changed".into()));
        }
        outside
    }

    /// What the asset should hold now: the present state, or the saved one while comparing.
    pub fn shown(&self, id: AssetId<A>) -> Option<&A> {
        let document = self.documents.get(&id)?;
        Some(if self.toolbar.comparing {
            document.saved()
        } else {
            document.present()
        })
    }

    /// Carries a command out. `folder` is where files of this kind lie, `saved` what "reset" goes back to.
    pub fn run(
        &mut self,
        id: AssetId<A>,
        command: Command,
        folder: &Path,
        saved: Option<A>,
        gesture: u64,
    ) {
        let Some(document) = self.documents.get_mut(&id) else {
            return;
        };
        let bar = &mut self.toolbar;
        bar.message = None;
        let short = |path: &Path| {
            path.file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned()
        };
        let written = |path: PathBuf| Some(Ok(format!("Saved {}", short(&path))));
        match command {
            Command::Undo => drop(document.undo().map(|_| bar.comparing = false)),
            Command::Redo => drop(document.redo().map(|_| bar.comparing = false)),
            Command::Compare(on) => bar.comparing = on,
            Command::Reset => {
                if let Some(mut saved) = saved {
                    saved.keep_handles(document.present());
                    bar.message = document
                        .edit(saved, gesture)
                        .err()
                        .map(|error| Err(error.to_string()));
                }
            }
            Command::Save { overwrite } => match document.save(None, overwrite) {
                Ok(path) => {
                    bar.asking = false;
                    bar.message = written(path);
                }
                Err(DocumentError::Conflict(_)) => bar.asking = true,
                Err(error) => bar.message = Some(Err(error.to_string())),
            },
            Command::SaveAs(name) => {
                let file = folder.join(format!("{name}.{}", A::EXTENSION));
                bar.message = match document.save(Some(&file), false) {
                    Ok(path) => written(path),
                    Err(DocumentError::Conflict(file)) => {
                        let file = short(Path::new(&file));
                        Some(Err(format!("{file} exists already: choose another name")))
                    }
                    Err(error) => Some(Err(error.to_string())),
                };
            }
            Command::Load(file) => {
                bar.asking = false;
                bar.message = match document.load(&file, gesture) {
                    Ok(_) => Some(Ok(format!("Loaded {}", short(&file)))),
                    // The folder is the usual one, and would take the room of what is wrong.
                    Err(error) => {
                        let path = file.display().to_string();
                        Some(Err(error.to_string().replace(&path, &short(&file))))
                    }
                };
            }
        }
    }
}

/// Files of one kind in a folder, sorted.
pub fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let suffix = format!(".{extension}");
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.to_string_lossy().ends_with(&suffix))
        .collect();
    files.sort();
    files
}
