//! What a panel asks for; carried out after all panels are drawn.

use std::path::PathBuf;

/// A request about the document shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Command {
    /// One step back.
    Undo,
    /// One step forward.
    Redo,
    /// Back to what was last saved.
    Reset,
    /// Write the file; `overwrite` also when somebody else has changed it.
    Save {
        /// The answer to the question whether to overwrite.
        overwrite: bool,
    },
    /// Write another file of this name in the same folder.
    SaveAs(String),
    /// Read a state from a file.
    Load(PathBuf),
    /// Show the state last saved instead of the present one, or no longer.
    Compare(bool),
}
