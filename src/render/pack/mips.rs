//! Mip levels of layers of bytes.

/// Appends a layer of `CHANNELS` bytes a texel and its mip levels (halved by plain averages while both sides are above `least`), largest
/// first; returns the number of levels.
pub fn append_with_mips<const CHANNELS: u32>(
    data: &mut Vec<u8>,
    mut level: Vec<u8>,
    mut width: u32,
    mut height: u32,
    least: u32,
) -> u32 {
    let mut count = 1;
    data.extend_from_slice(&level);
    while width > least && height > least {
        let (w, h) = (width / 2, height / 2);
        let mut next = Vec::with_capacity((w * h * CHANNELS) as usize);
        for y in 0..h {
            for x in 0..w {
                for c in 0..CHANNELS {
                    let at = |dx: u32, dy: u32| {
                        let place = ((2 * y + dy) * width + 2 * x + dx) * CHANNELS + c;
                        u32::from(level[place as usize])
                    };
                    next.push(((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1) + 2) / 4) as u8);
                }
            }
        }
        data.extend_from_slice(&next);
        (level, width, height) = (next, w, h);
        count += 1;
    }
    count
}
