//! Every method and setting of the charts: as a Rust function and as the WGSL that does the same.

use bevy_plumage::maths::query::{
    Cell, ErrorBudget, Evaluator, Local, Lod, cell_coverage, choose, lattice_coverage,
    mean_coverage, near_coverage, stripe_coverage,
};
use plumage_reference::query_published::{Method as Published, Orders};

/// Group of methods that share a color.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// The chooser with a budget.
    Chosen,
    /// One evaluator, where the chooser picks it.
    Forced(Evaluator),
    /// Point supersampling.
    Points,
    /// Gauss-Legendre nodes across the barbs.
    Spatial,
    /// The frequency domain.
    Frequency,
    /// Spatial near, frequency far, as published.
    Switch,
}

impl Family {
    /// Name in charts and tables.
    pub fn name(self) -> String {
        match self {
            Self::Chosen => "chosen".into(),
            Self::Forced(evaluator) => format!("{evaluator:?}").to_uppercase(),
            Self::Points => "point samples".into(),
            Self::Spatial => "spatial, published".into(),
            Self::Frequency => "frequency, published".into(),
            Self::Switch => "hard switch, published".into(),
        }
    }
}

/// The WGSL of a method.
pub struct Wgsl {
    /// Files besides those of the query.
    pub files: &'static [&'static str],
    /// Imports and the function `measured`.
    pub text: String,
}

type Function = Box<dyn Fn(&Cell<f32>, &Local<f32>) -> [f32; 3]>;

/// One method with its setting.
pub struct Method {
    /// Its family.
    pub family: Family,
    /// The setting, in words.
    pub setting: String,
    /// On the CPU.
    pub cpu: Function,
    /// On the GPU, where the shader has the setting.
    pub wgsl: Option<Wgsl>,
}

/// What every WGSL text starts with.
const IMPORTS: &str = "#import bevy_plumage::masking::Cell
#import bevy_plumage::query_far::Local
";

fn wgsl(import: &str, expression: &str) -> Wgsl {
    Wgsl {
        files: &[],
        text: format!(
            "{IMPORTS}{import}\nfn measured(cell: Cell, local: Local) -> vec3<f32> {{ return {expression}; }}"
        ),
    }
}

fn published_wgsl(kind: &str, numbers: [i64; 4]) -> Wgsl {
    let [samples, nodes, stripes, window] = numbers;
    Wgsl {
        files: &["query_published.wgsl"],
        ..wgsl(
            "#import bevy_plumage::query_published as p",
            &format!(
                "p::published_evaluate(cell, local, p::PublishedMethod(p::{kind}, {samples}u, {nodes}u, {stripes}, {window}))"
            ),
        )
    }
}

/// Nothing but the loop around a method.
pub fn empty() -> Wgsl {
    wgsl("", "vec3(local.u, local.tau, cell.s_d)")
}

/// A trilinear texture fetch.
pub fn texture() -> Wgsl {
    wgsl(
        "",
        "textureSampleLevel(picture, smooth_sampler, vec2(local.u, local.tau + cell.s_d), 1.5 + local.u).xyz",
    )
}

/// The chooser with a budget.
fn chosen(name: &str, epsilon: f32) -> Method {
    let budget = ErrorBudget::new(epsilon);
    let threshold = budget.threshold();
    Method {
        family: Family::Chosen,
        setting: name.into(),
        cpu: Box::new(move |cell, local| cell_coverage(cell, local, Lod::Mixed, &budget)),
        wgsl: Some(wgsl(
            "#import bevy_plumage::query::{cell_coverage, LOD_MIXED}",
            &format!("cell_coverage(cell, local, LOD_MIXED, {threshold:?})"),
        )),
    }
}

fn forced(evaluator: Evaluator, name: &str, cpu: Function, import: &str, call: &str) -> Method {
    Method {
        family: Family::Forced(evaluator),
        setting: name.into(),
        cpu,
        wgsl: Some(wgsl(import, call)),
    }
}

/// Disjoint shares, as the renderer clamps every method.
fn clamped([barb, upper, lower]: [f32; 3]) -> [f32; 3] {
    let barb = barb.clamp(0.0, 1.0);
    let upper = upper.clamp(0.0, 1.0 - barb);
    [barb, upper, lower.clamp(0.0, 1.0 - barb - upper)]
}

fn published(
    family: Family,
    setting: String,
    method: Published<f32>,
    wgsl: Option<Wgsl>,
) -> Method {
    Method {
        family,
        setting,
        cpu: Box::new(move |cell, local| clamped(method.evaluate(cell, local))),
        wgsl,
    }
}

/// Name of the setting that users get if they set nothing.
pub const DEFAULT: &str = "1/510 (default)";
/// Name of the published hard switch that the renderer offers.
pub const SWITCH: &str = "16 nodes, orders 1 and 2";

/// All of them.
pub fn all() -> Vec<Method> {
    let mut methods = vec![
        chosen("1/100", 0.01),
        chosen("1/255", 1.0 / 255.0),
        chosen(DEFAULT, ErrorBudget::<f32>::default().epsilon),
        chosen("1/2000", 0.0005),
        chosen("1/4000", 0.000_25),
    ];
    methods.extend(forced_all());
    for count in [4, 16, 64, 256] {
        methods.push(published(
            Family::Points,
            format!("{count} samples"),
            Published::Points(count),
            Some(published_wgsl(
                "PUBLISHED_POINTS",
                [i64::from(count), 6, 1, 2],
            )),
        ));
    }
    for count in [6usize, 16, 32, 64, 96] {
        let wgsl = published_wgsl("PUBLISHED_SPATIAL", [1, count as i64, 1, 2]);
        methods.push(published(
            Family::Spatial,
            format!("{count} nodes"),
            Published::Spatial(Published::nodes(count)),
            (count <= 64).then_some(wgsl),
        ));
    }
    for (stripes, window) in [(1, 2), (2, 4), (4, 8)] {
        let wgsl = published_wgsl(
            "PUBLISHED_FREQUENCY",
            [1, 6, i64::from(stripes), i64::from(window)],
        );
        methods.push(published(
            Family::Frequency,
            format!("orders {stripes} and {window}"),
            Published::Frequency(Orders { stripes, window }),
            Some(wgsl),
        ));
    }
    for (nodes, stripes, window, name) in [
        (6usize, 1, 2, "6 nodes, orders 1 and 2"),
        (16, 1, 2, SWITCH),
        (64, 4, 8, "64 nodes, orders 4 and 8"),
    ] {
        let wgsl = published_wgsl(
            "PUBLISHED_SWITCH",
            [1, nodes as i64, i64::from(stripes), i64::from(window)],
        );
        methods.push(published(
            Family::Switch,
            name.into(),
            Published::HardSwitch(Published::nodes(nodes), Orders { stripes, window }),
            Some(wgsl),
        ));
    }
    methods
}

fn forced_all() -> Vec<Method> {
    let budget = ErrorBudget::<f32>::default();
    let threshold = budget.threshold();
    let near_at = |name: &str, epsilon: f32| {
        let budget = ErrorBudget::new(epsilon);
        let threshold = budget.threshold();
        forced(
            Evaluator::Near,
            name,
            Box::new(move |cell, local| near_coverage(cell, local, &budget.quality)),
            "#import bevy_plumage::query_near::{near_coverage, quality_for_threshold}",
            &format!("near_coverage(cell, local, quality_for_threshold({threshold:?}, false))"),
        )
    };
    vec![
        near_at("1/100", 0.01),
        near_at("1/255", 1.0 / 255.0),
        near_at(DEFAULT, budget.epsilon),
        forced(
            Evaluator::Lattice,
            "default",
            Box::new(move |cell, local| {
                lattice_coverage(cell, local, choose(cell, local, threshold).row_budget)
            }),
            "#import bevy_plumage::query::choose\n#import bevy_plumage::query_far::lattice_coverage",
            &format!(
                "lattice_coverage(cell, local, choose(cell, local, {threshold:?}).row_budget)"
            ),
        ),
        forced(
            Evaluator::Stripe,
            "closed form",
            Box::new(stripe_coverage),
            "#import bevy_plumage::query_far::stripe_coverage",
            "stripe_coverage(cell, local)",
        ),
        forced(
            Evaluator::Mean,
            "constant",
            Box::new(|cell, _| mean_coverage(cell)),
            "#import bevy_plumage::query_far::mean_coverage",
            "mean_coverage(cell)",
        ),
    ]
}

/// What the chooser picks at the default budget.
pub fn kind(cell: &Cell<f32>, local: &Local<f32>) -> Evaluator {
    choose(cell, local, ErrorBudget::<f32>::default().threshold()).evaluator
}
