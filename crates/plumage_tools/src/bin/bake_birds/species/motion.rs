//! The idle clip as data: keys of (seconds, value).

/// Keys of one value over time; none for a value that rests at zero.
pub type Track = &'static [(f32, f32)];

/// The idle clip of a bird.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// Length, seconds.
    pub seconds: f32,
    /// When the wing is stretched furthest, seconds.
    pub stretched: f32,
    /// When it is half-way there, seconds.
    pub half_way: f32,
    /// Breaths in the clip. At rest 17.2 a minute over (mass in kg)^0.31 (Calder 1968).
    pub breaths: f32,
    /// Growth of the chest in a breath, as a share.
    pub swell: f32,
    /// Rise of the hips in a breath, mm.
    pub bob: f32,
    /// Turn of the tail against it, degrees.
    pub counter: f32,
    /// When the body shakes, seconds, and how often a second.
    pub rouse: [f32; 2],
    /// Wagging of the tail.
    pub flick: Option<Flick>,
    /// Left and right wing: share of the way from folded to half open.
    pub wings: [Track; 2],
    /// Tail fan beyond that at rest, degrees.
    pub fan: Track,
    /// Turn of the head to the left, degrees.
    pub yaw: Track,
    /// Its nod downwards, degrees.
    pub pitch: Track,
    /// Its tilt, degrees.
    pub roll: Track,
    /// The bill.
    pub jaw: Jaw,
    /// When the eyes blink, seconds.
    pub blinks: &'static [f32],
    /// A foot that takes hold anew.
    pub grip: Option<Grip>,
}

/// A tail that wags.
#[derive(Clone, Copy, Debug)]
pub struct Flick {
    /// From, to; seconds.
    pub span: [f32; 2],
    /// Seconds to its full width and back.
    pub ease: f32,
    /// Width to one side, degrees.
    pub degrees: f32,
    /// How often a second.
    pub rate: f32,
}

/// A bill that opens.
#[derive(Clone, Copy, Debug)]
pub struct Jaw {
    /// From, to, seconds to fully open and back.
    pub pulses: &'static [[f32; 3]],
    /// Turn of the lower jaw, degrees.
    pub open: f32,
    /// Turn of the upper bill, degrees.
    pub lift: f32,
}

/// A toe that opens and closes.
#[derive(Clone, Copy, Debug)]
pub struct Grip {
    /// From, to; seconds.
    pub span: [f32; 2],
    /// Seconds to fully open and back.
    pub ease: f32,
    /// Turn at its root, degrees.
    pub degrees: f32,
}
