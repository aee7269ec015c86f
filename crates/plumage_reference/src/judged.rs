//! The light of a vane as somebody else's renderer sees it, and what the crate makes of the same.
//!
//! `data/judged_vanes.csv` is written by `make judge`: Mitsuba 3 follows paths through explicit fibres with the radii, periods and
//! storeys of three presets (smooth dielectric walls, absorbing cortex, scattering medulla or mirror core). `judge/judge.py` says
//! what the columns are. The crate is given Mitsuba's own light of one fibre alone, so that what is compared is the vane: coverage,
//! shadows between fibres, and light that meets several of them.

use bevy_plumage::maths::{
    query::{
        Vane, VaneEye, grating_frequency, mask_vane, mean_coverage, vane_caught, vane_eye,
        vane_ray, vane_shadow,
    },
    scattering::{
        Fibre, FibreKind, FibreLobes, FibreReach, FibreRow, FibreShading, FibreTable, KeptLight,
        MEDULLA_PLACE, PARALLEL_MEETINGS, fibre_albedo, fibre_along, fibre_lit, fibre_lobes,
        fibre_local, fibre_shading, kept_at, kept_light, mean_caught, mirror_place,
        multiple_scattering, part_tangent,
    },
    vector::{cross, normalize},
};
use std::f64::consts::PI;

/// One figure of both.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Vane, color, eye and light.
    pub name: String,
    /// Mitsuba's.
    pub traced: f64,
    /// Its standard deviation.
    pub deviation: f64,
    /// The crate's.
    pub model: f64,
}

impl Judged {
    /// The crate's over Mitsuba's, less one.
    pub fn error(&self) -> f64 {
        self.model / self.traced - 1.0
    }
}

/// Everything compared.
#[derive(Clone, Debug, Default)]
pub struct Verdict {
    /// Energies of one fibre: surface, light that met neither medulla nor core, the rest.
    pub fibres: Vec<Judged>,
    /// Coverage by barbs, distal and proximal barbules, and open area.
    pub coverage: Vec<Judged>,
    /// Light that met one fibre.
    pub one: Vec<Judged>,
    /// All light.
    pub all: Vec<Judged>,
    /// Light from all around that comes back: white fibres, then others.
    pub furnace: Vec<Judged>,
}

/// The table in the repository.
pub const TABLE: &str = include_str!("../data/judged_vanes.csv");

/// Half angle of a light in the table.
const CONE: f64 = 15.0;

/// What becomes of a part's light: met others and spread, factor on what met one fibre, met one fibre.
struct Again {
    spread: f64,
    cone: f64,
    direct: f64,
}

/// What an eye sees of a vane.
struct Seen {
    covered: [f64; 3],
    sight: VaneEye<f64>,
    shadings: [FibreShading<f64>; 3],
}

/// One of the vanes in the table.
struct Subject {
    vane: Vane<f64>,
    table: FibreTable,
    structural: bool,
    kept: [KeptLight; 2],
    caught: f64,
}

fn fibre(structural: bool) -> Fibre {
    Fibre {
        kind: if structural {
            FibreKind::Structural { core_radius: 0.7 }
        } else {
            Fibre::default().kind
        },
        // As near to smooth walls as the crate goes.
        longitudinal_roughness: 0.05,
        azimuthal_roughness: 0.2,
        tilt: 0.0,
        ..Fibre::default()
    }
}

impl Subject {
    /// Sizes in micrometres, as in `judge/judge.py`.
    fn new(name: &str) -> Option<Self> {
        Self::of(name, fibre(name == "remex"))
    }

    /// Of other fibres.
    fn of(name: &str, fibre: Fibre) -> Option<Self> {
        let (pitch, angle, barb, barbule, structural) = match name {
            "covert" => (380.0, 38.0_f64, 14.0, 37.5_f64, false),
            "remex" => (450.0, 33.0, 30.0, 40.0, true),
            "eagle" => (550.0, 42.0, 17.5, 37.5, false),
            _ => return None,
        };
        let spacing = if name == "eagle" { 35.5 } else { 34.5 };
        let angle = angle.to_radians();
        let vane = Vane::new(
            pitch * angle.sin(),
            spacing,
            angle,
            barbule.to_radians(),
            barb,
            6.0,
            5.5,
        );
        let table = FibreTable::build(&fibre);
        let kept = [true, false].map(|front| kept_light(&vane, [&table; 4], 0.0, front));
        Some(Self {
            vane,
            structural,
            kept,
            caught: mean_caught(&vane),
            table,
        })
    }

    /// From across and along the barbs to the canonical frame.
    fn canonical(&self, [s, t, n]: [f64; 3]) -> [f64; 3] {
        let v = &self.vane;
        [s * v.cos_b - t * v.sin_b, s * v.sin_b + t * v.cos_b, n]
    }

    /// Albedo of a fibre of a color (absorption, or reflectance of the core).
    fn albedo(&self, color: f64) -> f64 {
        let row = self.table.row(1.0);
        if self.structural {
            let c = row[2][0];
            row[0][0] + row[0][3] * color * (1.0 - c) / (1.0 - c * color)
        } else {
            let p = self.table.fibre();
            let t = p.color_t;
            p.fresnel + (1.0 - p.fresnel) * (-p.color_kt / t * (color * t).ln_1p()).exp()
        }
    }

    fn coverage(&self, eye: [f64; 3]) -> [f64; 3] {
        let [barb, upper, lower] = mean_coverage(&mask_vane(&self.vane, self.canonical(eye)));
        if eye[2] >= 0.0 {
            [barb, upper, lower]
        } else {
            [barb, lower, upper]
        }
    }

    /// A part's fibre prepared for an eye, and its row of the table.
    fn shading(
        &self,
        part: usize,
        eye: [f64; 3],
        color: f64,
    ) -> (FibreRow<f64>, FibreShading<f64>) {
        let tangent = part_tangent(&self.vane, part);
        let local = fibre_local(tangent, [0.0, 0.0, 1.0], self.canonical(eye));
        let row = self.table.row((1.0 - local[0] * local[0]).max(0.0).sqrt());
        let albedo = [self.albedo(color); 3];
        let shading = fibre_shading(&self.table.fibre(), &row, albedo, local, 0.0, 8);
        (row, shading)
    }

    /// A part's light that meets others, and what one fibre alone sends back of light from all around.
    fn again(&self, part: usize, eye: [f64; 3], shading: &FibreShading<f64>) -> Again {
        let kept = &self.kept[usize::from(eye[2] < 0.0)][part];
        let direct: f64 = (0..2)
            .map(|side| {
                let shares = kept_at(&kept[side], eye);
                (0..4)
                    .map(|lobe| shading.energy[lobe][0] * shares[lobe])
                    .sum::<f64>()
            })
            .sum();
        let albedo = fibre_albedo(shading);
        let meeting = (1.0 - direct / albedo[0]).clamp(0.0, 1.0);
        let parallel = if self.structural {
            PARALLEL_MEETINGS
        } else {
            0.0
        };
        let again = multiple_scattering(albedo, [meeting; 3], parallel);
        Again {
            spread: again.spread[0],
            cone: again.cone[0],
            direct,
        }
    }

    /// What an eye sees of a vane, whatever lights it.
    fn seen(&self, color: f64, eye: [f64; 3]) -> Seen {
        let place = mirror_place(&self.table);
        Seen {
            covered: self.coverage(eye),
            sight: vane_eye(&self.vane, self.canonical(eye), [place; 2]),
            shadings: [1, 2, 3].map(|part| self.shading(part, eye, color).1),
        }
    }

    /// Radiance to that eye over irradiance of a light.
    fn lit(&self, seen: &Seen, eye: [f64; 3], light: [f64; 3]) -> f64 {
        let direction = self.canonical(light);
        let to = vane_ray(&seen.sight, direction);
        let reached = vane_shadow(&seen.sight, &to);
        let caught =
            vane_caught(&seen.sight.shape, &to.storeys, to.facing) / (4.0 * PI * self.caught);
        let mut sum = 0.0;
        for (k, shading) in seen.shadings.iter().enumerate() {
            let part = k + 1;
            let tangent = part_tangent(&self.vane, part);
            let lobes = fibre_lobes(shading, fibre_local(tangent, [0.0, 0.0, 1.0], direction));
            let direct =
                reached[part].mirror * lobes.mirror[0] + reached[part].even * lobes.even[0];
            let again = self.again(part, eye, shading);
            sum += seen.covered[k] * (again.cone * direct + again.spread * caught);
        }
        sum
    }

    /// Light of one fibre, and all light, from a cone around `light`. `k`: of each part's fibre alone.
    fn light(&self, color: f64, eye: [f64; 3], light: [f64; 3], k: [[f64; 2]; 3]) -> [f64; 2] {
        let covered = self.coverage(eye);
        let place = mirror_place(&self.table);
        let sight = vane_eye(&self.vane, self.canonical(eye), [place; 2]);
        let frequency =
            (grating_frequency(&self.vane, sight.distal_above) / MEDULLA_PLACE.1).powi(2);
        let shadings = [1, 2, 3].map(|part| {
            let (row, shading) = self.shading(part, eye, color);
            let p = self.table.fibre();
            FibreShading {
                along: fibre_along(&p, &row, shading.absorption, frequency),
                ..shading
            }
        });
        let agains = [0, 1, 2].map(|i| self.again(i + 1, eye, &shadings[i]));
        let spread_again: f64 = (0..3).map(|i| covered[i] * agains[i].spread).sum();
        let directions = cone(light).map(|direction| self.canonical(direction));
        // A smooth fibre lights only a curve through the cone, so its light is spread over it as the crate's own.
        let spread = [0, 1, 2].map(|i| {
            let tangent = part_tangent(&self.vane, i + 1);
            let own = directions.map(|direction| {
                let local = fibre_local(tangent, [0.0, 0.0, 1.0], direction);
                let lobes = fibre_lobes(&shadings[i], local);
                [lobes.mirror[0], lobes.even[0]]
            });
            [0, 1].map(|lobe| {
                let mean = own.iter().map(|own| own[lobe]).sum::<f64>() / COUNT as f64;
                own.map(|own| {
                    if mean > 1e-9 {
                        k[i][lobe] * own[lobe] / mean
                    } else {
                        k[i][lobe]
                    }
                })
            })
        });
        let (mut one, mut all) = (0.0, 0.0);
        let solid_angle = 2.0 * PI * (1.0 - CONE.to_radians().cos());
        for (d, direction) in directions.iter().enumerate() {
            let to = vane_ray(&sight, *direction);
            let reached = vane_shadow(&sight, &to);
            for (i, shading) in shadings.iter().enumerate() {
                let part = i + 1;
                let local =
                    fibre_local(part_tangent(&self.vane, part), [0.0, 0.0, 1.0], *direction);
                let across = local[1].hypot(local[2]).max(1e-9);
                let turn = (local[1] * shading.azimuth[0] + local[2] * shading.azimuth[1]) / across;
                let lobes = FibreLobes {
                    mirror: [spread[i][0][d]; 3],
                    even: [spread[i][1][d]; 3],
                    turn,
                };
                let light = reached[part];
                let reach = FibreReach {
                    mirror: light.mirror,
                    even: light.even,
                    along: light.along,
                    place: light.place,
                };
                let lit = covered[i] * fibre_lit(shading, &lobes, &reach)[0];
                one += lit;
                all += agains[i].cone * lit;
            }
            let caught = vane_caught(&sight.shape, &to.storeys, to.facing);
            all += spread_again * caught / (4.0 * PI * self.caught) * solid_angle;
        }
        let share = 1.0 / COUNT as f64;
        [one * share, all * share]
    }
}

/// Directions of one light.
const COUNT: usize = 192;

/// Directions spread evenly over a light.
fn cone(middle: [f64; 3]) -> [[f64; 3]; COUNT] {
    let side = normalize(cross([0.3, 0.5, 0.81], middle), [1.0, 0.0, 0.0]);
    let other = cross(middle, side);
    std::array::from_fn(|i| {
        let share = (i as f64 + 0.5) / COUNT as f64;
        let z = 1.0 - (1.0 - CONE.to_radians().cos()) * share;
        let r = (1.0 - z * z).sqrt();
        let (sin, cos) = (2.399_963_229_728_653 * i as f64).sin_cos();
        std::array::from_fn(|k| middle[k] * z + r * (cos * side[k] + sin * other[k]))
    })
}

/// Fibres of a white vane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhiteFibre {
    /// A pigment fibre that absorbs nothing.
    Pigment,
    /// A smooth mirror core.
    Structural,
    /// A mirror core under a wall as rough as the crate allows, which throws most light back and spreads it widely: the nearest to a
    /// diffuse opaque fibre that the model knows.
    Diffuse,
}

/// What comes back to an eye (across and along the barbs, up) of light from all around a vane of white fibres (of a covert, or a remex
/// where they have a core) when every direction of light is evaluated as a light of its own; over what is covered.
pub fn furnace_by_lights(fibres: WhiteFibre, eye: [f64; 3]) -> Option<f64> {
    const DIRECTIONS: usize = 6000;
    let subject = match fibres {
        WhiteFibre::Pigment => Subject::new("covert")?,
        WhiteFibre::Structural => Subject::new("remex")?,
        WhiteFibre::Diffuse => Subject::of(
            "remex",
            Fibre {
                longitudinal_roughness: 0.8,
                azimuthal_roughness: 1.0,
                ..fibre(true)
            },
        )?,
    };
    let color = if fibres == WhiteFibre::Pigment {
        0.0
    } else {
        1.0
    };
    let seen = subject.seen(color, eye);
    let mut sum = 0.0;
    for i in 0..DIRECTIONS {
        let z = 1.0 - 2.0 * (i as f64 + 0.5) / DIRECTIONS as f64;
        let (sin, cos) = (2.399_963_229_728_653 * i as f64).sin_cos();
        let r = (1.0 - z * z).sqrt();
        sum += subject.lit(&seen, eye, [r * cos, r * sin, z]);
    }
    Some(sum * 4.0 * PI / DIRECTIONS as f64 / seen.covered.iter().sum::<f64>())
}

/// A vane of fibres as rough as the presets', painted in one color.
pub struct PaintedVane(Subject, f64);

impl PaintedVane {
    /// `covert`, `remex` or `eagle`; absorption of the color, or reflectance of a remex's cores.
    pub fn new(name: &str, color: f64) -> Option<Self> {
        let kind = fibre(name == "remex").kind;
        let fibre = Fibre {
            kind,
            ..Fibre::default()
        };
        Some(Self(Subject::of(name, fibre)?, color))
    }

    /// Radiance to an eye over irradiance of a light, over what is covered; directions across and along the barbs, up.
    pub fn radiance(&self, eye: [f64; 3], light: [f64; 3]) -> f64 {
        let seen = self.0.seen(self.1, eye);
        self.0.lit(&seen, eye, light) / seen.covered.iter().sum::<f64>().max(1e-9)
    }
}

/// Compares the crate with a table; rows that it does not know are left out.
pub fn judge(table: &str) -> Verdict {
    let mut verdict = Verdict::default();
    let mut subjects: Vec<(String, Subject)> = Vec::new();
    let tables = [false, true].map(|structural| FibreTable::build(&fibre(structural)));
    for line in table.lines() {
        let fields: Vec<&str> = line.split(',').collect();
        let [kind, name, rest @ ..] = fields.as_slice() else {
            continue;
        };
        let numbers: Vec<f64> = rest.iter().filter_map(|x| x.parse().ok()).collect();
        if *kind == "fibre" {
            if let [theta, color, energies @ ..] = numbers.as_slice() {
                one_fibre(&mut verdict, name, *theta, *color, energies, &tables);
            }
            continue;
        }
        if !subjects.iter().any(|(known, _)| known == name) {
            let Some(subject) = Subject::new(name) else {
                continue;
            };
            subjects.push(((*name).to_owned(), subject));
        }
        let Some((_, subject)) = subjects.iter().find(|(known, _)| known == name) else {
            continue;
        };
        subject.row(&mut verdict, kind, name, &numbers);
    }
    verdict
}

fn one_fibre(
    verdict: &mut Verdict,
    kind: &str,
    theta: f64,
    color: f64,
    traced: &[f64],
    tables: &[FibreTable; 2],
) {
    let structural = kind == "structural";
    let table = &tables[usize::from(structural)];
    let p = table.fibre();
    let row = table.row(theta.to_radians().cos());
    let transmitted = |kt: f64, t: f64| (-kt / t.max(1e-4) * (color * t.max(1e-4)).ln_1p()).exp();
    let model = if structural {
        let c = row[2][0];
        let core = row[0][3] * color * (1.0 - c) / (1.0 - c * color);
        [row[0][0], row[0][1] + row[0][2], core]
    } else {
        let beside = row[0][1] * transmitted(row[1][0], row[1][1])
            + row[0][2] * transmitted(row[1][2], row[1][3]);
        [
            row[0][0],
            beside,
            row[0][3] * transmitted(row[2][0], row[2][1]),
        ]
    };
    debug_assert!(p.eta > 1.0);
    for (part, (traced, model)) in ["R", "beside", "inside"]
        .iter()
        .zip(traced.iter().zip(model))
    {
        verdict.fibres.push(Judged {
            name: format!("{kind} {color} at {theta}: {part}"),
            traced: *traced,
            deviation: 0.0,
            model,
        });
    }
}

fn degrees(direction: &[f64]) -> String {
    let angle = direction[2].abs().min(1.0).acos().to_degrees().round();
    let axis = if direction[0].abs() > direction[1].abs() {
        ["-x", "x"][usize::from(direction[0] > 0.0)]
    } else {
        ["-y", "y"][usize::from(direction[1] > 0.0)]
    };
    let back = if direction[2] < 0.0 { "b" } else { "" };
    if angle == 0.0 {
        format!("{back}n")
    } else {
        format!("{back}{angle}{axis}")
    }
}

impl Subject {
    fn row(&self, verdict: &mut Verdict, kind: &str, name: &str, n: &[f64]) {
        match (kind, n.len()) {
            ("coverage", 6) => {
                let eye = [n[0], n[1], n[2]];
                let [b, d, p] = self.coverage(eye);
                let traced = [n[3], n[4], n[5], 1.0 - n[3] - n[4] - n[5]];
                let parts = ["barb", "distal", "proximal", "open"];
                for ((part, traced), model) in
                    parts.iter().zip(traced).zip([b, d, p, 1.0 - b - d - p])
                {
                    verdict.coverage.push(Judged {
                        name: format!("{name} {} {part}", degrees(&eye)),
                        traced,
                        deviation: 0.0,
                        model,
                    });
                }
            }
            ("light", 17) => {
                let (eye, light) = ([n[1], n[2], n[3]], [n[4], n[5], n[6]]);
                let k = [[n[7], n[8]], [n[9], n[10]], [n[11], n[12]]];
                let [one, all] = self.light(n[0], eye, light, k);
                let name = format!("{name} {} {}/{}", n[0], degrees(&eye), degrees(&light));
                for (list, model, at) in [(&mut verdict.one, one, 13), (&mut verdict.all, all, 15)]
                {
                    list.push(Judged {
                        name: name.clone(),
                        traced: n[at],
                        deviation: n[at + 1],
                        model,
                    });
                }
            }
            ("furnace", 6) => {
                let eye = [n[1], n[2], n[3]];
                let covered = self.coverage(eye);
                let mut sum = 0.0;
                for (i, share) in covered.iter().enumerate() {
                    let (_, shading) = self.shading(i + 1, eye, n[0]);
                    let again = self.again(i + 1, eye, &shading);
                    sum += share * (again.cone * again.direct + again.spread);
                }
                verdict.furnace.push(Judged {
                    name: format!("{name} {} {}", n[0], degrees(&eye)),
                    traced: n[5],
                    deviation: 0.0,
                    model: sum / covered.iter().sum::<f64>(),
                });
            }
            _ => {}
        }
    }
}
