//! A bar on the terminal; a line for each step where the output goes to a file.

use std::io::{IsTerminal, Write, stdout};

/// Characters of the bar.
const WIDE: usize = 30;

/// The bar, and what it says.
#[derive(Default)]
pub struct Progress {
    said: String,
}

impl Progress {
    /// Shows a share of the whole, 0..1, and what is being done.
    pub fn show(&mut self, share: f32, doing: &str) {
        let full = (share.clamp(0.0, 1.0) * WIDE as f32).round() as usize;
        let bar = "#".repeat(full) + &".".repeat(WIDE - full);
        let line = format!("[{bar}] {:3.0} % {doing}", 100.0 * share);
        if line == self.said {
            return;
        }
        if stdout().is_terminal() {
            print!("\rbake: {line:<70}");
        } else {
            println!("bake: {line}");
        }
        let _ = stdout().flush();
        self.said = line;
    }
}
