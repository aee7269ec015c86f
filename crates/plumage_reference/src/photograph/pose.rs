//! Where the feather lies in the frame.

use super::Setting;
use bevy_plumage::anatomy::{Feather, FeatherMap};

/// A plane with the feather on it, seen by a camera above: turn, scale, mirror and a little perspective.
///
/// *Plane* coordinates are in feather lengths from the middle of the feather's card, x right and y to the tip.
#[derive(Clone, Debug)]
pub struct Pose {
    /// Pixel of the middle of the card.
    pub centre: [f64; 2],
    /// Pixels per feather length in the middle of the card.
    pub scale: f64,
    /// -1 where the back lies up, else 1.
    mirror: f64,
    cos: f64,
    sin: f64,
    tilt: [f64; 2],
    aspect: f64,
    map: FeatherMap,
}

impl Pose {
    /// The pose that fills the frame as the setting says.
    pub fn new(setting: &Setting, feather: &Feather) -> Self {
        let (sin, cos) = setting.rotation.sin_cos();
        let size = setting.size.map(f64::from);
        let mut pose = Self {
            centre: [0.0; 2],
            scale: 1.0,
            mirror: if setting.back { -1.0 } else { 1.0 },
            cos,
            sin,
            tilt: setting.tilt.map(|tilt| tilt.clamp(-0.3, 0.3)),
            aspect: f64::from(feather.aspect),
            map: feather.map(),
        };
        let half = 0.5 * pose.aspect;
        let corners = [[-half, -0.5], [half, -0.5], [half, 0.5], [-half, 0.5]];
        let places = corners.map(|corner| pose.pixel_of_plane(corner));
        let range = |axis: usize| {
            let values = places.map(|place| place[axis]);
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            (low, high)
        };
        let ranges = [range(0), range(1)];
        let fill = setting.fill.clamp(0.05, 1.0);
        pose.scale = (0..2)
            .map(|axis| fill * size[axis] / (ranges[axis].1 - ranges[axis].0).max(1e-6))
            .fold(f64::INFINITY, f64::min);
        for axis in 0..2 {
            let (low, high) = ranges[axis];
            let room = size[axis] * 0.97 - (high - low) * pose.scale;
            let middle = 0.5 * (low + high) * pose.scale;
            pose.centre[axis] =
                0.5 * size[axis] - middle + 0.5 * room.max(0.0) * setting.position[axis];
        }
        pose
    }

    /// Pixel of a plane point.
    pub fn pixel_of_plane(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let near = 1.0 + self.tilt[0] * x + self.tilt[1] * y;
        let [x, y] = [self.mirror * x / near, y / near];
        [
            self.centre[0] + self.scale * (x * self.cos + y * self.sin),
            self.centre[1] + self.scale * (x * self.sin - y * self.cos),
        ]
    }

    /// Plane point of a pixel.
    pub fn plane(&self, pixel: [f64; 2]) -> [f64; 2] {
        let d = [
            (pixel[0] - self.centre[0]) / self.scale,
            (pixel[1] - self.centre[1]) / self.scale,
        ];
        let r = [
            self.mirror * (d[0] * self.cos + d[1] * self.sin),
            d[0] * self.sin - d[1] * self.cos,
        ];
        let near = 1.0 - self.tilt[0] * r[0] - self.tilt[1] * r[1];
        r.map(|value| value / near.max(0.1))
    }

    /// Pixel of a point of the feather's UV rectangle.
    pub fn pixel(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        self.pixel_of_plane([(u - 0.5) * self.aspect, v - 0.5])
    }

    /// UV point under a pixel.
    pub fn uv(&self, pixel: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.plane(pixel);
        [x / self.aspect + 0.5, y + 0.5]
    }

    /// Pixel of a canonical point (rachis on x = 0, feather lengths).
    pub fn pixel_of_canonical(&self, point: [f64; 2]) -> [f64; 2] {
        self.pixel(self.map.uv(point))
    }

    /// Canonical point under a pixel.
    pub fn canonical(&self, pixel: [f64; 2]) -> [f64; 2] {
        self.map.canonical(self.uv(pixel))
    }

    /// Derivatives of [`Self::uv`] by the pixel's x and y.
    pub fn uv_derivatives(&self, pixel: [f64; 2]) -> [[f64; 2]; 2] {
        let h = 0.25;
        let along = |step: [f64; 2]| {
            let low = self.uv([pixel[0] - step[0], pixel[1] - step[1]]);
            let high = self.uv([pixel[0] + step[0], pixel[1] + step[1]]);
            [
                (high[0] - low[0]) / (2.0 * h),
                (high[1] - low[1]) / (2.0 * h),
            ]
        };
        [along([h, 0.0]), along([0.0, h])]
    }

    /// The feather's own map.
    pub fn map(&self) -> &FeatherMap {
        &self.map
    }

    /// A direction in the frame (x right, y down) as a direction in the plane.
    pub fn plane_direction(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            self.mirror * (x * self.cos + y * self.sin),
            x * self.sin - y * self.cos,
        ]
    }
}
