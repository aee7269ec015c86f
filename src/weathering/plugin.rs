//! The component and the system that keeps cards and feathers as it says.

use crate::{
    anatomy::{Feather, Weather},
    groom::{Card, CardRoots, Channel, FeathersOf, PlumageCards, PlumageSystems},
    maths::seed::{Stream, mix},
    modified::modified,
};
use bevy::{
    app::{App, Plugin, Update},
    asset::{AssetEvent, AssetServer, Assets, Handle},
    ecs::prelude::*,
    image::Image,
    log::warn,
    reflect::{Reflect, std_traits::ReflectDefault},
    render::renderer::RenderDevice,
};
use std::sync::Arc;

/// Shares of the weather that feathers are made for; each card wears the nearest above or below its own, by chance.
const LEVELS: [f32; 2] = [0.5, 1.0];
/// Layers of the albedo texture for one feather: front and back.
const LAYERS: usize = 2;
/// Seed of that chance.
const CHANCE: u64 = 0x7765_7400;

/// Weather of one bird: put it beside `Plumage`, or on card meshes of the app's own. Change it and the feathers follow, without a new
/// groom: their colors, their outlines (wet barbs cling together in clumps) and their gloss. Costs a GPU nothing by the fragment, and
/// two more feathers for each of the bird's (one without a mask); its textures are painted anew with every change, which takes some
/// milliseconds. Down below the feathers stays dry.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct Weathering {
    /// Where the mask is white, or all over without one.
    pub weather: Weather,
    /// Where on the skin, by its texture coordinates (`TEXCOORD_0`): looked up where a feather is rooted.
    pub mask: Option<Handle<Image>>,
    /// The mask's channel; its numbers count as the file has them.
    pub channel: Channel,
}

impl Weathering {
    /// This weather all over.
    pub fn new(weather: Weather) -> Self {
        Self {
            weather,
            ..Self::default()
        }
    }

    /// As much of it as a mask says.
    pub fn with_mask(mut self, mask: Handle<Image>) -> Self {
        self.mask = Some(mask);
        self
    }

    fn is_none(&self) -> bool {
        self.weather.scaled(1.0) == Weather::default()
    }
}

/// Takes [`Weathering`] over to the feathers. One of the `PlumagePlugins`.
#[derive(Clone, Copy, Debug, Default)]
pub struct WeatheringPlugin;

impl Plugin for WeatheringPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Weathering>().add_systems(
            Update,
            weather_feathers
                .in_set(PlumageSystems::TakeWeather)
                .after(PlumageSystems::Groom)
                .after(PlumageSystems::TakeSkinColors)
                // An app without images has no masks.
                .run_if(resource_exists::<Assets<Image>>)
                .run_if(any_with_component::<Weathering>.or_else(any_with_component::<Weathered>)),
        );
    }
}

/// On a card mesh whose feathers are weathered: what they are without, and by what.
#[derive(Component)]
struct Weathered {
    asked: Weathering,
    clean: Arc<[Card]>,
    feathers: Vec<Handle<Feather>>,
    /// The cards that are worn instead.
    cards: Arc<[Card]>,
}

fn weather_feathers(
    mut commands: Commands,
    mut feather_events: MessageReader<AssetEvent<Feather>>,
    mut image_events: MessageReader<AssetEvent<Image>>,
    server: Res<AssetServer>,
    images: Res<Assets<Image>>,
    device: Option<Res<RenderDevice>>,
    mut feathers: ResMut<Assets<Feather>>,
    weatherings: Query<&Weathering>,
    mut birds: Query<(
        Entity,
        &mut PlumageCards,
        Option<&CardRoots>,
        Option<&mut Weathered>,
        Option<&FeathersOf>,
    )>,
) {
    let (changed, pictures) = (modified(&mut feather_events), modified(&mut image_events));
    let most =
        device.map_or(64, |device| device.limits().max_texture_array_layers) as usize / LAYERS;
    for (entity, mut cards, roots, weathered, of) in &mut birds {
        let asked = weatherings.get(FeathersOf::owner(of, entity));
        let asked = asked.ok().filter(|asked| !asked.is_none());
        // What the skin's color or the app have put there since is not weathered.
        let clean = match &weathered {
            Some(known) if Arc::ptr_eq(&known.cards, &cards.cards) => known.clean.clone(),
            _ => cards.cards.clone(),
        };
        let Some(asked) = asked else {
            if weathered.is_some() {
                (cards.cards, cards.weathered) = (clean, Vec::new());
                commands.entity(entity).remove::<Weathered>();
            }
            continue;
        };
        let own = &cards.feathers;
        let current = weathered.as_ref().is_some_and(|known| {
            known.asked == *asked
                && Arc::ptr_eq(&known.cards, &cards.cards)
                && known.feathers == *own
                && !own.iter().any(|feather| changed.contains(&feather.id()))
                && !asked
                    .mask
                    .as_ref()
                    .is_some_and(|mask| pictures.contains(&mask.id()))
        });
        if current {
            continue;
        }
        let mut levels: &[f32] = &LEVELS;
        if asked.mask.is_none() || (1 + levels.len()) * own.len() > most {
            levels = &LEVELS[1..];
        }
        if (1 + levels.len()) * own.len() > most {
            if weathered.is_none_or(|known| known.asked != *asked) {
                warn!(
                    "{} feathers have no weather: the device has room for {most} in all",
                    own.len()
                );
            }
            continue;
        }
        let mask = match &asked.mask {
            None => None,
            Some(mask) => match (images.get(mask), server.load_state(mask).is_failed()) {
                (None, false) => continue,
                // The server has said so; then the weather is all over.
                (found, _) => found,
            },
        };
        let Some(dry) = own
            .iter()
            .map(|feather| feathers.get(feather).cloned())
            .collect::<Option<Vec<_>>>()
        else {
            continue;
        };
        let mut worn = Vec::with_capacity(levels.len() * own.len());
        for (i, level) in levels.iter().enumerate() {
            let weather = asked.weather.scaled(*level);
            for (k, feather) in dry.iter().enumerate() {
                let feather = feather.weathered(weather);
                let handle = match cards.weathered.get(i * dry.len() + k) {
                    Some(handle) => {
                        // Only its own birds have it.
                        let _ = feathers.insert(handle.id(), feather);
                        handle.clone()
                    }
                    None => feathers.add(feather),
                };
                worn.push(handle);
            }
        }
        let levels: Vec<Weather> = levels
            .iter()
            .map(|level| asked.weather.scaled(*level))
            .collect();
        let share = |i: usize| match (mask, roots) {
            (Some(mask), Some(CardRoots { skin, roots })) => roots
                .get(i)
                .map_or(1.0, |root| skin.picture_share(mask, asked.channel, *root)),
            _ => 1.0,
        };
        let weathered_cards: Arc<[Card]> = clean
            .iter()
            .enumerate()
            .map(|(i, card)| weathered_card(card, share(i), &levels, own.len()))
            .collect();
        commands.entity(entity).insert(Weathered {
            asked: asked.clone(),
            clean,
            feathers: own.clone(),
            cards: weathered_cards.clone(),
        });
        (cards.cards, cards.weathered) = (weathered_cards, worn);
    }
}

/// A card with so much weather, 0..1: of `count` feathers the clean ones come first, then those of each level.
fn weathered_card(card: &Card, share: f32, levels: &[Weather], count: usize) -> Card {
    let chance = Stream::new(mix(CHANCE, u64::from(card.seed))).uniform();
    let level = ((share * levels.len() as f32 + chance) as usize).min(levels.len());
    let mut card = *card;
    if let Some(weather) = level.checked_sub(1).and_then(|i| levels.get(i)) {
        card.feather += (level * count) as u16;
        card.tint = weather.color(card.tint);
    }
    card
}
