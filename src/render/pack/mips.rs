//! Mip levels of RGBA8 layers.

/// Appends a layer and its mip levels (halved by plain averages), largest first; returns the number of levels.
pub fn append_with_mips(
    data: &mut Vec<u8>,
    mut level: Vec<u8>,
    mut width: u32,
    mut height: u32,
) -> u32 {
    let mut count = 1;
    data.extend_from_slice(&level);
    while width > 4 && height > 4 {
        let (w, h) = (width / 2, height / 2);
        let mut next = Vec::with_capacity((w * h * 4) as usize);
        for y in 0..h {
            for x in 0..w {
                for c in 0..4 {
                    let at = |dx: u32, dy: u32| {
                        u32::from(level[(((2 * y + dy) * width + 2 * x + dx) * 4 + c) as usize])
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
