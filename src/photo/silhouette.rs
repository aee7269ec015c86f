//! From the photograph to the feather's silhouette in an upright view.

use super::{
    Confidence, Doubt, ExtractError, ExtractSettings,
    background::Background,
    color::Lab,
    find::{Found, find, place},
    held::{Held, nearer, without},
    objects::{Overview, choose},
    outline,
    prepare::{Photo, View, denoise},
    raster::Plane,
    segment::{Segment, largest, segment, with_thin_ends},
};
use bevy::math::Vec2;
use image::{DynamicImage, GrayImage, Luma, RgbaImage};
use imageproc::{distance_transform::Norm, morphology};

/// Confidence left in a feather whose lower end a hand hides, and in one that has other colors where the border cuts it: it may be
/// held by what they belong to.
const HELD: f32 = 0.8;
const BANDED: f32 = 0.7;
/// Longest side of the view that finds the feather.
const OVERVIEW: f32 = 800.0;
/// Points of the refined outline, at most.
const OUTLINE_POINTS: usize = 4096;

/// A closed vane's outline is at most this much longer than its smoothed course.
const RAGGED: f32 = 1.12;

/// A feather more slender than this lies along the main direction of its outline.
pub(super) const SLENDER: f32 = 2.2;

/// The feather upright (its main direction along y), cut out.
pub(super) struct Silhouette {
    pub view: View,
    /// Pixels of the view, as photographed.
    pub image: RgbaImage,
    /// The view without noise.
    pub lab: Lab,
    pub mask: GrayImage,
    /// Closed outline in pixels of the view, at equal steps.
    pub outline: Vec<Vec2>,
    /// Field that is 0 on the outline.
    pub field: Plane,
    /// Distance of each pixel's color to the background's.
    pub far: Plane,
    /// Extent along the main direction over that across it.
    pub slender: f32,
    /// Noise of the ground.
    pub noise: f32,
    /// Middle of what holds the feather, in pixels of the photograph.
    pub held: Option<Vec2>,
}

impl Silhouette {
    /// The same upside down.
    pub fn turned(mut self) -> Self {
        let size = Vec2::new(self.view.width as f32, self.view.height as f32);
        self.view = self.view.turned();
        image::imageops::rotate180_in_place(&mut self.image);
        image::imageops::rotate180_in_place(&mut self.mask);
        for plane in &mut self.lab.planes {
            plane.data.reverse();
        }
        self.field.data.reverse();
        self.far.data.reverse();
        for point in &mut self.outline {
            *point = size - *point;
        }
        self
    }
}

/// Is there an alpha channel that cuts something out?
fn cut_out(photo: &RgbaImage) -> bool {
    let mut clear = 0usize;
    let mut solid = 0usize;
    for pixel in photo.pixels() {
        clear += usize::from(pixel[3] < 128);
        solid += usize::from(pixel[3] >= 128);
    }
    clear * 200 > solid && solid * 1000 > clear
}

fn alpha_segment(image: &RgbaImage) -> Segment {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let field = Plane::from_fn(width, height, |x, y| {
        f32::from(image.get_pixel(x as u32, y as u32)[3]) / 255.0 - 0.5
    });
    let mask = GrayImage::from_fn(image.width(), image.height(), |x, y| {
        Luma([if image.get_pixel(x, y)[3] >= 128 {
            255
        } else {
            0
        }])
    });
    let least = (width * height / 4000).max(12) as u32;
    let all = mask;
    let (mask, area, others) = largest(&all, least);
    Segment {
        loose: mask.clone(),
        all,
        far: Plane::new(width, height, 1.0),
        mask,
        field,
        others: others
            .iter()
            .map(|&a| a as f32 / area.max(1) as f32)
            .collect(),
        threshold: 0.5,
        shadow: 0.0,
        bitten: 0.0,
    }
}

/// Middle and main direction of a mask, and how slender it is (deviation along over across).
fn principal(mask: &GrayImage) -> Option<(Vec2, Vec2, f32)> {
    let (mut count, mut sum) = (0.0f64, [0.0f64; 2]);
    let mut squares = [0.0f64; 3];
    for (x, y, pixel) in mask.enumerate_pixels() {
        if pixel[0] > 0 {
            let (x, y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
            count += 1.0;
            sum = [sum[0] + x, sum[1] + y];
            squares = [squares[0] + x * x, squares[1] + x * y, squares[2] + y * y];
        }
    }
    if count < 1.0 {
        return None;
    }
    let (mx, my) = (sum[0] / count, sum[1] / count);
    let (xx, xy, yy) = (
        squares[0] / count - mx * mx,
        squares[1] / count - mx * my,
        squares[2] / count - my * my,
    );
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    let (mean, root) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    let slender = ((mean + root) / (mean - root).max(1e-6)).sqrt();
    Some((
        Vec2::new(mx as f32, my as f32),
        Vec2::from_angle(angle as f32),
        slender as f32,
    ))
}

/// Stripes of a masked picture as (place from `middle`, doubled direction, strength).
fn stripes(light: &Plane, mask: &GrayImage, middle: Vec2) -> Vec<(Vec2, Vec2, f32)> {
    let detail = light.blur(1.0).zip(&light.blur(5.0), |a, b| a - b);
    let inner = morphology::erode(mask, Norm::L2, 4);
    let on = inner
        .enumerate_pixels()
        .filter(|(_, _, pixel)| pixel[0] > 0);
    on.step_by(2)
        .map(|(x, y, _)| {
            let g = detail.gradient(x as usize, y as usize);
            let place = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - middle;
            // The square of the complex number: opposite gradients agree.
            (
                place,
                Vec2::new(g.x * g.x - g.y * g.y, 2.0 * g.x * g.y),
                g.length_squared(),
            )
        })
        .collect()
}

/// Direction of the feather. A long one lies along the main direction of its mask; for one nearly as wide as long, the axis
/// about which outline and barbs are best mirrored says more.
fn direction(mask: &GrayImage, light: &Plane, (middle, main, slender): (Vec2, Vec2, f32)) -> Vec2 {
    if slender > SLENDER {
        return main;
    }
    let step = (mask.width() * mask.height() / 60_000).max(1) as usize;
    let on: Vec<Vec2> = mask
        .enumerate_pixels()
        .step_by(step)
        .filter(|(_, _, pixel)| pixel[0] > 0)
        .map(|(x, y, _)| Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - middle)
        .collect();
    let barbs = stripes(light, mask, middle);
    let symmetry = |axis: Vec2| {
        let mirrored = on.iter().filter(|p| {
            let q = middle + axis * p.dot(axis) - axis.perp() * p.dot(axis.perp());
            let inside =
                q.x >= 0.0 && q.y >= 0.0 && q.x < mask.width() as f32 && q.y < mask.height() as f32;
            inside && mask.get_pixel(q.x as u32, q.y as u32)[0] > 0
        });
        // Barbs right of the axis mirror those on its left: the product of their mean doubled directions, seen from the
        // axis, is then real and positive.
        let turn = Vec2::new(axis.x * axis.x - axis.y * axis.y, -2.0 * axis.x * axis.y);
        let mut sides = [(Vec2::ZERO, 1e-9); 2];
        for (place, doubled, strength) in &barbs {
            let side = &mut sides[usize::from(place.dot(axis.perp()) > 0.0)];
            side.0 += doubled.rotate(turn);
            side.1 += strength;
        }
        let [left, right] = sides.map(|(sum, weight)| sum / weight);
        let lean = 0.04 * (slender - 1.0) * axis.dot(main).abs();
        mirrored.count() as f32 / on.len().max(1) as f32 + 0.8 * left.rotate(right).x + lean
    };
    (0..60)
        .map(|i| Vec2::from_angle(std::f32::consts::PI * i as f32 / 60.0))
        .map(|axis| (symmetry(axis), axis))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(main, |(_, axis)| axis)
}

/// Finds the feather, turns the view upright and cuts it out anew at the resolution asked for. `turn` is the angle from the main
/// direction of its outline to that of the view; without it the view takes the likeliest.
pub(super) fn silhouette(
    photograph: &DynamicImage,
    settings: &ExtractSettings,
    turn: Option<f32>,
    confidence: &mut Confidence,
) -> Result<Silhouette, ExtractError> {
    let size = Vec2::new(photograph.width() as f32, photograph.height() as f32);
    let longest = size.max_element();
    let overview = Photo::reduced(photograph, OVERVIEW);
    let enlarge = (OVERVIEW / longest).clamp(1.0, 2.0);
    let whole = View {
        origin: Vec2::ZERO,
        axis: Vec2::X,
        scale: overview.step.x.max(overview.step.y) / enlarge,
        width: (overview.image.width() as f32 * enlarge).round() as usize,
        height: (overview.image.height() as f32 * enlarge).round() as usize,
    };
    let (image, _) = overview.look(&whole);
    let by_alpha = settings.use_alpha && cut_out(&image);
    let (seen, held, mut found) = if by_alpha {
        (None, Held::Free, alpha_segment(&image))
    } else {
        let lab = Lab::of(&denoise(&image));
        let Found {
            background,
            segment,
            held,
        } = find(&lab)?;
        let behind: Vec<[f32; 3]> = (0..whole.width * whole.height)
            .map(|i| {
                let (x, y) = (i % whole.width, i / whole.width);
                background.behind(place(x, y, whole.width, whole.height), lab.at(i))
            })
            .collect();
        (Some((background, behind)), held, segment)
    };
    let area = found.mask.as_raw().iter().filter(|&&m| m > 0).count();
    let share = area as f32 / (whole.width * whole.height) as f32;
    if area < 60 || share < 0.001 {
        return Err(ExtractError::NoFeather {
            reason: "nothing stands out from the background".to_owned(),
        });
    }
    if share > 0.93 && !by_alpha {
        return Err(ExtractError::NoFeather {
            reason: "no background around it".to_owned(),
        });
    }
    let colors = Lab::of(&image);
    let holder = match held {
        Held::By(holder) => Some(holder),
        Held::Unclear { apart, least } => return Err(ExtractError::Held { apart, least }),
        Held::Banded => {
            let doubt = Doubt::Shape("of other colors towards the picture's border");
            confidence.one_feather.doubt(doubt, BANDED);
            None
        }
        Held::Free | Held::Cut => None,
    };
    let holding = holder.as_ref().map(|holder| {
        // Its surroundings are its own, too.
        let feather = without(&found.mask, holder);
        let around = nearer(holder, &feather);
        found.mask = largest(&without(&found.mask, &around), 1).0;
        found.all = without(&found.all, &around);
        found.loose = without(&found.loose, &around);
        around
    });
    let overview = Overview {
        view: &whole,
        colors: seen.as_ref().map(|(_, behind)| (&colors, &behind[..])),
    };
    let mut found = choose(&found, &overview, settings.object)?;
    if let Some(holding) = holding {
        let foreign = found
            .foreign
            .get_or_insert_with(|| GrayImage::new(holding.width(), holding.height()));
        for (pixel, own) in foreign.iter_mut().zip(holding.iter()) {
            *pixel |= own;
        }
        confidence.one_feather.doubt(Doubt::Held, HELD);
    }
    let background = seen.map(|(background, _)| background);
    if found.shadows > 0 {
        confidence
            .one_feather
            .doubt(Doubt::ShadowsApart(found.shadows), 0.9);
    }
    let beside = found.others.iter().filter(|&&share| share > 0.01).count() as u32;
    if beside > 0 {
        let worst = found.others.iter().copied().fold(0.0, f32::max);
        confidence
            .one_feather
            .doubt(Doubt::OtherObjects(beside), 1.0 - worst.min(0.5));
    }

    // Upright view around what was found.
    let silhouette = with_thin_ends(&found.mask, &found.loose);
    let lie = principal(&silhouette).unwrap_or((Vec2::ZERO, Vec2::Y, 1.0));
    let slender = lie.2;
    let along = match turn {
        Some(turn) => Vec2::from_angle(turn).rotate(lie.1),
        None => direction(&silhouette, &colors.planes[0], lie),
    };
    // The view's x axis; its y axis is then `along`, which shall point down the screen.
    let along = if along.y < 0.0 { -along } else { along };
    let axis = -along.perp();
    let corners: Vec<Vec2> = outline::border(&silhouette)
        .into_iter()
        .map(|p| whole.photo(p))
        .collect();
    let extent = |direction: Vec2| {
        corners.iter().fold((f32::MAX, f32::MIN), |(low, high), p| {
            let at = p.dot(direction);
            (low.min(at), high.max(at))
        })
    };
    let ((x0, x1), (mut y0, mut y1)) = (extent(axis), extent(along));
    // The quill may be as thin as a line: look for it straight on from both ends.
    let room = 0.3 * (x1 - x0) + 0.04 * (y1 - y0);
    for (x, y, pixel) in found.loose.enumerate_pixels() {
        let p = whole.photo(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
        if pixel[0] > 0 && (x0 - room..x1 + room).contains(&p.dot(axis)) {
            (y0, y1) = (y0.min(p.dot(along)), y1.max(p.dot(along)));
        }
    }
    let (across, long) = (x1 - x0, y1 - y0);
    let (side, end) = (0.10 * across + 0.02 * long + 4.0, 0.05 * long + 4.0);
    let scale = ((long + 2.0 * end).max(across + 2.0 * side) / settings.resolution as f32).max(0.5);
    let view = View {
        origin: axis * (x0 - side) + along * (y0 - end),
        axis,
        scale,
        width: ((across + 2.0 * side) / scale).ceil().max(8.0) as usize,
        height: ((long + 2.0 * end) / scale).ceil().max(8.0) as usize,
    };
    let photo = Photo::reduced(photograph, 1.2 * longest / scale);
    let (mut image, mut valid) = photo.look(&view);
    if let Some(foreign) = &found.foreign {
        // What belongs to another object is as good as beyond the frame.
        for y in 0..view.height {
            for x in 0..view.width {
                let p = whole.view(view.photo(Vec2::new(x as f32 + 0.5, y as f32 + 0.5)));
                let side = Vec2::new(whole.width as f32, whole.height as f32) - 1.0;
                let p = p.clamp(Vec2::ZERO, side).as_uvec2();
                if foreign.get_pixel(p.x, p.y)[0] > 0 {
                    valid.data[y * view.width + x] = 0.0;
                    if by_alpha {
                        image.get_pixel_mut(x as u32, y as u32)[3] = 0;
                    }
                }
            }
        }
    }
    let lab = Lab::of(&denoise(&image));
    let cut = match &background {
        None => alpha_segment(&image),
        Some(background) => {
            let at = |x: usize, y: usize| {
                let p = view.photo(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
                p / size * 2.0 - 1.0
            };
            let length = long / scale;
            let open = (length / 500.0).round().clamp(1.0, 3.0) as u8;
            let close = (length / 200.0).round().clamp(2.0, 8.0) as u8;
            let band = (long / scale * 0.012).clamp(2.5, 16.0);
            segment(
                &lab,
                background,
                &at,
                Some(&valid),
                [open, close],
                [band, 1.0 / scale],
            )
        }
    };
    let points = outline::refine(&outline::border(&cut.mask), &cut.field, 2.5);
    if points.len() < 32 {
        return Err(ExtractError::NoFeather {
            reason: "the object found has too few pixels".to_owned(),
        });
    }
    let count = (outline::length(&points) as usize).clamp(256, OUTLINE_POINTS);
    let outline = outline::resample(&points, count, true);
    judge(
        &cut,
        &view,
        size,
        &outline,
        background.as_ref(),
        long,
        confidence,
    );
    Ok(Silhouette {
        view,
        image,
        lab,
        mask: cut.mask,
        outline,
        field: cut.field,
        far: cut.far,
        slender,
        noise: background
            .as_ref()
            .map_or(0.0, |background| background.noise),
        held: holder
            .and_then(|holder| principal(&holder))
            .map(|lie| whole.photo(lie.0)),
    })
}

/// Notes what makes the outline doubtful.
fn judge(
    cut: &Segment,
    view: &View,
    size: Vec2,
    outline_points: &[Vec2],
    background: Option<&Background>,
    long: f32,
    confidence: &mut Confidence,
) {
    let trust = &mut confidence.contour;
    if let Some(background) = background {
        let inside = cut.field.data.iter().zip(cut.mask.as_raw());
        let mut levels: Vec<f32> = inside
            .filter(|(_, m)| **m > 0)
            .map(|(f, _)| f + cut.threshold)
            .collect();
        let level = super::raster::quantile(&mut levels, 0.25);
        let ratio = level / background.most.max(0.004);
        if ratio < 4.0 {
            trust.doubt(Doubt::LowContrast(ratio), (ratio / 4.0).max(0.2));
        }
        if background.noise > 0.06 {
            let factor = (0.06 / background.noise).sqrt();
            trust.doubt(Doubt::UnevenBackground(background.noise), factor);
        }
        if cut.shadow > 0.03 {
            trust.doubt(Doubt::Shadow(cut.shadow), 1.0 - cut.shadow.min(0.6));
        }
    }
    if cut.bitten > 0.004 {
        let factor = 1.0 / (1.0 + 30.0 * cut.bitten);
        trust.doubt(Doubt::Bitten(cut.bitten), factor);
    }
    let ragged = outline::raggedness(outline_points, 0.02);
    if ragged > RAGGED {
        trust.doubt(Doubt::Ragged(ragged), (RAGGED / ragged).powi(8).max(0.5));
    }
    let margin = 1.5 * view.scale.max(1.0);
    let touching = outline_points
        .iter()
        .filter(|p| {
            let p = view.photo(**p);
            p.min(size - p).min_element() < margin
        })
        .count();
    let cut_length = touching as f32 * outline::length(outline_points)
        / outline_points.len() as f32
        * view.scale
        / long.max(1.0);
    if cut_length > 0.005 {
        confidence.one_feather.doubt(
            Doubt::CutByFrame(cut_length),
            (1.0 - 2.0 * cut_length).max(0.1),
        );
    }
    if long < 200.0 {
        confidence
            .contour
            .doubt(Doubt::FewPixels(long), (long / 200.0).sqrt());
    }
}
