//! Undo and redo.

/// Most steps kept.
const CAPACITY: usize = 128;

/// The states of a value, oldest first, with a cursor.
///
/// Edits of one *gesture* (a drag of a slider) become one step.
#[derive(Clone, Debug)]
pub struct History<T> {
    states: Vec<T>,
    cursor: usize,
    gesture: Option<u64>,
}

impl<T: Clone + PartialEq> History<T> {
    /// A history of one state.
    pub fn new(first: T) -> Self {
        Self {
            states: vec![first],
            cursor: 0,
            gesture: None,
        }
    }

    /// The present state.
    pub fn present(&self) -> &T {
        &self.states[self.cursor]
    }

    /// Records an edit; whether it is a new state. What was undone before is forgotten; edits with the same gesture as the last
    /// one replace it.
    pub fn edit(&mut self, value: T, gesture: u64) -> bool {
        if *self.present() == value {
            return false;
        }
        self.states.truncate(self.cursor + 1);
        if self.gesture == Some(gesture) && self.cursor > 0 {
            self.states[self.cursor] = value;
        } else {
            self.states.push(value);
            if self.states.len() > CAPACITY {
                self.states.remove(0);
            }
            self.cursor = self.states.len() - 1;
        }
        self.gesture = Some(gesture);
        true
    }

    /// Steps back; the state that is now present, or `None` at the beginning.
    pub fn undo(&mut self) -> Option<&T> {
        self.gesture = None;
        self.cursor = self.cursor.checked_sub(1)?;
        Some(&self.states[self.cursor])
    }

    /// Steps forward; the state that is now present, or `None` at the end.
    pub fn redo(&mut self) -> Option<&T> {
        self.gesture = None;
        if self.cursor + 1 >= self.states.len() {
            return None;
        }
        self.cursor += 1;
        Some(&self.states[self.cursor])
    }

    /// Number of steps that can be undone and redone.
    pub fn depth(&self) -> (usize, usize) {
        (self.cursor, self.states.len() - 1 - self.cursor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_steps_back_and_forth() {
        let mut history = History::new(0);
        for value in 1..=10 {
            assert!(history.edit(value, value as u64));
        }
        assert_eq!(history.depth(), (10, 0));
        for value in (0..10).rev() {
            assert_eq!(history.undo(), Some(&value));
        }
        assert_eq!(history.undo(), None);
        assert_eq!(*history.present(), 0);
        for value in 1..=10 {
            assert_eq!(history.redo(), Some(&value));
        }
        assert_eq!(history.redo(), None);
    }

    #[test]
    fn one_drag_is_one_step() {
        let mut history = History::new(0.0);
        for value in [0.1, 0.2, 0.3] {
            history.edit(value, 7);
        }
        assert!(!history.edit(0.3, 7), "no change is no step");
        history.edit(0.5, 8);
        assert_eq!(history.depth(), (2, 0));
        assert_eq!(history.undo(), Some(&0.3));
        assert_eq!(history.undo(), Some(&0.0));
        // An edit after an undo forgets what was undone, and never merges into the state that was gone back to.
        history.edit(0.9, 8);
        assert_eq!(history.depth(), (1, 0));
        assert_eq!(history.undo(), Some(&0.0));
    }

    #[test]
    fn old_steps_fall_off() {
        let mut history = History::new(0);
        for value in 1..1000 {
            history.edit(value, value as u64);
        }
        assert_eq!(history.depth(), (CAPACITY - 1, 0));
        while history.undo().is_some() {}
        assert_eq!(*history.present(), 1000 - CAPACITY as i32);
    }
}
