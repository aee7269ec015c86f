//! What decides which pipeline draws a feather: of the material ([`FeatherPipelineKey`]) and of the pass ([`PassKey`]), and the
//! shader definitions that follow ([`shader_defs`]).

use bevy::{
    prelude::{AlphaMode, Reflect},
    shader::ShaderDefVal,
};
use serde::{Deserialize, Serialize};

/// How what lies behind a feather shows through it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect, Serialize, Deserialize)]
#[non_exhaustive]
pub enum FeatherTransparency {
    /// Coverage becomes MSAA samples: no sorting, writes depth. Wants `Msaa::Sample4`; with `Msaa::Off` it is [`Self::Hashed`].
    #[default]
    AlphaToCoverage,
    /// Every pixel is there or not, by a pattern fixed to the feather (Wyman and McGuire 2017): no sorting, writes depth, works
    /// without MSAA. Grainy in a single frame.
    Hashed,
    /// Interiors of vanes, almost opaque, are drawn with depth; only fringes go to Bevy's order-independent transparency, which
    /// the camera needs: `OrderIndependentTransparencySettings` and `Msaa::Off`. On cameras without it the feathers are drawn as
    /// with [`Self::AlphaToCoverage`], and a warning says so.
    OrderIndependent,
    /// Blended in the order of the mesh, without depth: exact for a single feather, wrong where feathers cover each other. A
    /// camera with order-independent transparency sorts the fragments.
    Blend,
}

/// Which fragments of a bird's cards a material draws. LOD classes use separate pipelines, so that a distant fragment does not
/// pay for what only near ones need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DrawnCards {
    /// Shadows of all; color and depth of what no other material draws.
    #[default]
    Own,
    /// The almost opaque interiors for [`FeatherTransparency::OrderIndependent`].
    Core,
    /// Color and depth of cards of the class FAR.
    Far,
    /// Color and depth of cards of the class MEAN.
    Mean,
    /// Color and depth of cards of the class LIT: MEAN, their light found at the vertices.
    Lit,
}

/// Under which lights a material draws its cards. FAR and MEAN cards have pipelines for either, both there from the beginning, so that
/// frames under suns do without the code of lamps and the first lamp finds its pipeline.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DrawnUnder {
    /// Whatever there is.
    #[default]
    Any,
    /// Directional lights alone, and the sky.
    Suns,
    /// Point, spot or rectangle lights, too.
    Lamps,
}

/// What of thin layers ([`Iridescence`](crate::Iridescence)) the shader knows. Their code is compiled for no bird that does
/// without.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ThinLayers {
    /// No feather has any.
    #[default]
    None,
    /// Every feather that has them has one thickness.
    Even,
    /// The thickness of some changes over the card.
    Graded,
}

/// How the shader finds the coverage of a pixel's footprint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect, Serialize, Deserialize)]
#[non_exhaustive]
pub enum CoverageMethod {
    /// The cheapest evaluator within the error budget ([`crate::maths::query::choose`]).
    #[default]
    Chosen,
    #[cfg(feature = "comparison")]
    /// The paper's own: spatial domain by Gauss-Legendre near, frequency domain far, a hard switch between them
    /// (Sec. 5). For comparison only.
    Published,
    #[cfg(feature = "comparison")]
    /// 1,024 point queries per footprint: slow, the truth that the others are compared with.
    Supersampled,
}

/// What makes two feather materials want different pipelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FeatherPipelineKey {
    /// `FeatherSettings::coverage_method`.
    pub coverage_method: CoverageMethod,
    /// `FeatherMaterial::transparency`.
    pub transparency: FeatherTransparency,
    /// The environment map is sampled by importance.
    pub sampled_environment: bool,
    /// Up to four lights are fetched before the fibres are looked at; otherwise one.
    pub lights_together: bool,
    /// `DebugView::Overdraw`.
    pub overdraw: bool,
    /// Another debug view.
    pub debug: bool,
    /// `FeatherMaterial::drawn`.
    pub drawn: DrawnCards,
    /// `FeatherMaterial::under`.
    pub under: DrawnUnder,
    /// `FeatherSettings::order_window` is open.
    pub ordered: bool,
    /// Fibres are read from their short tables.
    pub plain: bool,
    /// `FeatherMaterial::layers`.
    pub layers: ThinLayers,
}

impl FeatherPipelineKey {
    /// Whether every LOD class has a pipeline of its own. Blending keeps the order of the mesh, so its cards stay together; the
    /// methods that are there for comparison know no classes.
    pub fn splits(&self) -> bool {
        self.coverage_method == CoverageMethod::Chosen
            && matches!(
                self.transparency,
                FeatherTransparency::AlphaToCoverage | FeatherTransparency::Hashed
            )
    }

    /// The same for feathers whose fibres are all plain ([`crate::maths::scattering::FibreTable::is_plain`]), or not: FAR and MEAN cards
    /// have a short form of them, unless more than their color is asked of the fibres.
    pub fn with_plain_fibres(self, plain: bool) -> Self {
        let short = matches!(
            self.drawn,
            DrawnCards::Far | DrawnCards::Mean | DrawnCards::Lit
        ) && !(self.sampled_environment || self.overdraw || self.debug);
        Self {
            plain: plain && short,
            ..self
        }
    }

    /// Whether light may be found at the vertices: of plain fibres without thin layers, under prefiltered maps.
    pub fn lights_vertices(&self) -> bool {
        let mean = Self {
            drawn: DrawnCards::Mean,
            ..*self
        };
        self.splits()
            && self.layers == ThinLayers::None
            && !self.lights_together
            && mean.with_plain_fibres(true).plain
    }

    /// The phase of Bevy in which the material is drawn.
    pub fn alpha_mode(&self) -> AlphaMode {
        if self.overdraw {
            return AlphaMode::Add;
        }
        if self.drawn == DrawnCards::Core {
            return AlphaMode::Mask(0.5);
        }
        match self.transparency {
            FeatherTransparency::AlphaToCoverage => AlphaMode::AlphaToCoverage,
            FeatherTransparency::Hashed => AlphaMode::Mask(0.5),
            FeatherTransparency::OrderIndependent | FeatherTransparency::Blend => AlphaMode::Blend,
        }
    }

    /// Shader definitions that do not depend on the view.
    pub(super) fn shader_defs(&self) -> Vec<ShaderDefVal> {
        let mut defs = Vec::new();
        match self.coverage_method {
            CoverageMethod::Chosen => {}
            #[cfg(feature = "comparison")]
            CoverageMethod::Published => defs.push("PUBLISHED_COVERAGE".into()),
            #[cfg(feature = "comparison")]
            CoverageMethod::Supersampled => defs.push("SUPERSAMPLED_COVERAGE".into()),
        }
        if self.overdraw {
            defs.push("OVERDRAW".into());
        }
        match self.drawn {
            DrawnCards::Own if self.splits() => defs.push("ONLY_RESOLVED".into()),
            DrawnCards::Own | DrawnCards::Core => {}
            DrawnCards::Far => defs.push("ONLY_FAR".into()),
            DrawnCards::Mean => defs.push("ONLY_MEAN".into()),
            DrawnCards::Lit => defs.extend(["ONLY_MEAN".into(), "ONLY_LIT".into()]),
        }
        defs
    }

    /// Shader definitions that only color depends on.
    fn color_defs(&self) -> Vec<ShaderDefVal> {
        let mut defs = Vec::new();
        if self.sampled_environment {
            defs.push("SAMPLED_ENVIRONMENT".into());
        }
        if self.lights_together {
            defs.push("LIGHTS_TOGETHER".into());
        }
        if self.layers > ThinLayers::None {
            defs.push("IRIDESCENT".into());
        }
        if self.layers == ThinLayers::Graded {
            defs.push("GRADED_LAYERS".into());
        }
        if self.debug {
            defs.push("DEBUG_VIEW".into());
        }
        if self.plain {
            defs.push("PLAIN_FIBRES".into());
        }
        if self.under == DrawnUnder::Suns {
            defs.push("UNDER_SUNS".into());
        }
        defs
    }
}

/// What of a camera and its pass decides how coverage becomes pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PassKey {
    /// Color of a camera.
    Forward {
        /// Samples per pixel.
        samples: u32,
        /// The camera has a list of transparent fragments.
        listed: bool,
        /// A depth prepass has said which samples show which card.
        depth_prepass: bool,
    },
    /// Depth prepass of a camera, or a shadow map.
    Prepass {
        /// Samples per pixel.
        samples: u32,
        /// The camera has a list of transparent fragments.
        listed: bool,
        /// The shadow map of a directional light.
        directional: bool,
        /// The fragment stage writes more than depth.
        outputs: bool,
    },
}

/// What one pipeline does with a fragment's coverage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resolve {
    /// It becomes samples of the multisampled target.
    Samples(u32),
    /// There or not, by a pattern on the card.
    Hashed,
    /// Only almost opaque fragments.
    Core,
    /// Only the others, into the camera's list of transparent fragments.
    Fringe,
    /// All fragments, into the list.
    List,
    /// Alpha blending.
    Blend,
    /// Fragments are counted.
    Overdraw,
    /// Those that the depth prepass has left, each once.
    Decided,
    /// Those that the depth prepass has left, and those that the coat's order puts before them; samples per pixel, 1: by a pattern.
    Ordered(u32),
}

impl Resolve {
    /// What a pass does with the fragments of a material.
    pub fn choose(key: &FeatherPipelineKey, pass: &PassKey) -> Self {
        let (PassKey::Forward {
            samples, listed, ..
        }
        | PassKey::Prepass {
            samples, listed, ..
        }) = *pass;
        let solid = if samples > 1 {
            Self::Samples(samples)
        } else {
            Self::Hashed
        };
        let found = match key.transparency {
            _ if key.overdraw => Self::Overdraw,
            _ if key.drawn == DrawnCards::Core => Self::Core,
            FeatherTransparency::AlphaToCoverage => solid,
            FeatherTransparency::Hashed => Self::Hashed,
            FeatherTransparency::OrderIndependent if listed => Self::Fringe,
            FeatherTransparency::OrderIndependent => solid,
            FeatherTransparency::Blend if listed => Self::List,
            FeatherTransparency::Blend => Self::Blend,
        };
        match pass {
            PassKey::Forward {
                depth_prepass: true,
                ..
            } if found.is_solid() && key.alpha_mode() != AlphaMode::Blend => match found {
                _ if !key.ordered => Self::Decided,
                Self::Samples(samples) => Self::Ordered(samples),
                _ => Self::Ordered(1),
            },
            _ => found,
        }
    }

    /// Whether a fragment is there or not, sample by sample.
    pub fn is_solid(self) -> bool {
        matches!(self, Self::Samples(_) | Self::Hashed)
    }

    fn shader_defs(self) -> Vec<ShaderDefVal> {
        match self {
            Self::Samples(count) => vec![
                "SAMPLE_COVERAGE".into(),
                ShaderDefVal::UInt("FEATHER_SAMPLES".into(), count),
            ],
            Self::Hashed => vec!["HASHED".into()],
            Self::Core => vec!["FEATHER_CORE".into()],
            Self::Fringe => vec!["FEATHER_FRINGE".into(), "BLENDED".into()],
            Self::List | Self::Blend => vec!["BLENDED".into()],
            Self::Overdraw => Vec::new(),
            Self::Decided => vec!["DEPTH_DECIDED".into()],
            Self::Ordered(samples) => {
                let solid = match samples {
                    1 => Self::Hashed,
                    _ => Self::Samples(samples),
                };
                let mut defs = solid.shader_defs();
                defs.push("ORDER_WINDOW".into());
                defs
            }
        }
    }
}

/// Definitions of the vertex and of the fragment stage, beside Bevy's own.
pub fn shader_defs(key: &FeatherPipelineKey, pass: &PassKey) -> [Vec<ShaderDefVal>; 2] {
    let resolve = Resolve::choose(key, pass);
    let mut vertex = key.shader_defs();
    let mut fragment = key.shader_defs();
    fragment.extend(resolve.shader_defs());
    if matches!(resolve, Resolve::Ordered(_)) {
        vertex.push("ORDER_WINDOW".into());
    }
    match *pass {
        PassKey::Forward { .. } => {
            fragment.extend(key.color_defs());
            if key.drawn == DrawnCards::Lit {
                vertex.extend(key.color_defs());
                for stage in [&mut vertex, &mut fragment] {
                    stage.push("LIT_VERTICES".into());
                }
            }
        }
        PassKey::Prepass {
            directional,
            outputs,
            ..
        } => {
            if directional {
                vertex.push("DIRECTIONAL_SHADOW".into());
                fragment.push("DIRECTIONAL_SHADOW".into());
            }
            if outputs || matches!(resolve, Resolve::Samples(_)) {
                fragment.push("FEATHER_PREPASS_OUTPUT".into());
            }
        }
    }
    [vertex, fragment]
}

/// Every pair of a material and a pass that the plugin makes a pipeline for, for one number of samples above 1.
#[cfg(feature = "internals")]
pub fn pipelines(samples: u32) -> Vec<(FeatherPipelineKey, PassKey)> {
    let methods = [
        CoverageMethod::Chosen,
        #[cfg(feature = "comparison")]
        CoverageMethod::Published,
        #[cfg(feature = "comparison")]
        CoverageMethod::Supersampled,
    ];
    let transparencies = [
        FeatherTransparency::AlphaToCoverage,
        FeatherTransparency::Hashed,
        FeatherTransparency::OrderIndependent,
        FeatherTransparency::Blend,
    ];
    use DrawnUnder::{Any, Lamps, Suns};
    let drawings = [
        (DrawnCards::Own, Any),
        (DrawnCards::Core, Any),
        (DrawnCards::Far, Suns),
        (DrawnCards::Far, Lamps),
        (DrawnCards::Mean, Suns),
        (DrawnCards::Mean, Lamps),
        (DrawnCards::Lit, Suns),
    ];
    // What of sampled environment, lights together, overdraw, debug and thin layers goes together.
    use ThinLayers::{Even, Graded, None};
    let shown = [
        ([false, false, false, false], None),
        ([true, false, false, false], None),
        ([false, true, false, false], None),
        ([true, true, false, false], None),
        ([false, false, true, false], None),
        ([false, false, false, true], None),
        ([false, false, false, false], Even),
        ([false, false, false, false], Graded),
        ([true, true, false, false], Even),
        ([true, true, false, false], Graded),
        ([false, false, false, true], Even),
        ([false, false, false, true], Graded),
    ];
    let mut keys = Vec::new();
    for coverage_method in methods {
        for transparency in transparencies {
            for (drawn, under) in drawings {
                let flags = shown
                    .iter()
                    .flat_map(|flags| [(*flags, false), (*flags, true)]);
                for (([sampled_environment, lights_together, overdraw, debug], layers), ordered) in
                    flags
                {
                    // What counts fragments asks for no light.
                    let under = match under {
                        Lamps if overdraw => continue,
                        Suns if overdraw => Any,
                        under => under,
                    };
                    let key = FeatherPipelineKey {
                        coverage_method,
                        transparency,
                        sampled_environment,
                        lights_together,
                        overdraw,
                        debug,
                        drawn,
                        under,
                        ordered,
                        plain: false,
                        layers,
                    };
                    let made = match drawn {
                        DrawnCards::Own => true,
                        DrawnCards::Core => transparency == FeatherTransparency::OrderIndependent,
                        DrawnCards::Far | DrawnCards::Mean => key.splits(),
                        DrawnCards::Lit => key.lights_vertices(),
                    };
                    // Light at vertices is of plain fibres only.
                    if made && drawn != DrawnCards::Lit {
                        keys.push(key);
                    }
                    let plain = key.with_plain_fibres(true);
                    if made && plain != key {
                        keys.push(plain);
                    }
                }
            }
        }
    }
    let both = [false, true];
    let mut passes = Vec::new();
    // A list of transparent fragments and multisampling exclude each other.
    for (samples, listed) in [(1, false), (1, true), (samples, false)] {
        passes.extend(both.map(|depth_prepass| PassKey::Forward {
            samples,
            listed,
            depth_prepass,
        }));
        for directional in both {
            passes.extend(both.map(|outputs| PassKey::Prepass {
                samples,
                listed,
                directional,
                outputs,
            }));
        }
    }
    keys.iter()
        .flat_map(|key| passes.iter().map(|pass| (*key, *pass)))
        .collect()
}
