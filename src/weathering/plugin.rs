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
/// two more feathers for each of the bird's (one without a mask); they are painted and packed anew with every change. Down below the feathers stays dry.
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

    fn is_clean(&self) -> bool {
        self.weather.scaled(1.0) == Weather::default()
    }

    /// The weathers that feathers are made for; `None` where a device with room for `most` feathers has none for that many.
    fn levels(&self, feathers: usize, most: usize) -> Option<Vec<Weather>> {
        let fit = |levels: &&[f32]| (1 + levels.len()) * feathers <= most;
        let first = usize::from(self.mask.is_none());
        let shares = [&LEVELS[first..], &LEVELS[1..]].into_iter().find(fit)?;
        Some(
            shares
                .iter()
                .map(|share| self.weather.scaled(*share))
                .collect(),
        )
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

impl Weathered {
    fn is_current(&self, asked: &Weathering, cards: &PlumageCards) -> bool {
        self.asked == *asked
            && self.feathers == cards.feathers
            && Arc::ptr_eq(&self.cards, &cards.cards)
    }
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
        Option<&Weathered>,
        Option<&FeathersOf>,
    )>,
) {
    let (edited, painted) = (modified(&mut feather_events), modified(&mut image_events));
    let most =
        device.map_or(64, |device| device.limits().max_texture_array_layers) as usize / LAYERS;
    for (entity, mut cards, roots, weathered, of) in &mut birds {
        let asked = weatherings.get(FeathersOf::owner(of, entity));
        let asked = asked.ok().filter(|asked| !asked.is_clean());
        // What the skin's color or the app have put there since is not weathered.
        let clean = weathered.filter(|known| Arc::ptr_eq(&known.cards, &cards.cards));
        let clean = clean.map_or_else(|| cards.cards.clone(), |known| known.clean.clone());
        let Some(asked) = asked else {
            if weathered.is_some() {
                (cards.cards, cards.weathered) = (clean, Vec::new());
                commands.entity(entity).remove::<Weathered>();
            }
            continue;
        };
        let own = &cards.feathers;
        let repainted = asked.mask.as_ref().map(Handle::id);
        let stale = repainted.is_some_and(|mask| painted.contains(&mask))
            || own.iter().any(|feather| edited.contains(&feather.id()));
        if !stale && weathered.is_some_and(|known| known.is_current(asked, &cards)) {
            continue;
        }
        let Some(levels) = asked.levels(own.len(), most) else {
            if weathered.is_none_or(|known| known.asked != *asked) {
                let count = own.len();
                warn!("{count} feathers have no weather: the device has room for {most} in all");
            }
            continue;
        };
        let mask = asked.mask.as_ref().and_then(|mask| images.get(mask));
        // The server tells of a mask that does not come; then the weather is all over.
        let comes = |mask: &Handle<Image>| !server.load_state(mask).is_failed();
        if mask.is_none() && asked.mask.as_ref().is_some_and(comes) {
            continue;
        }
        let Some(worn) = weathered_feathers(&cards, &levels, &mut feathers) else {
            continue;
        };
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

/// The feathers of a bird in the weather of each level, in place of those it has already; none before all are loaded.
fn weathered_feathers(
    cards: &PlumageCards,
    levels: &[Weather],
    feathers: &mut Assets<Feather>,
) -> Option<Vec<Handle<Feather>>> {
    let clean = cards.feathers.iter().map(|own| feathers.get(own).cloned());
    let clean = clean.collect::<Option<Vec<_>>>()?;
    let weathered = levels
        .iter()
        .flat_map(|level| clean.iter().map(|own| own.weathered(*level)));
    let mut worn = Vec::with_capacity(levels.len() * clean.len());
    for (i, feather) in weathered.enumerate() {
        worn.push(match cards.weathered.get(i) {
            Some(handle) => {
                // No other bird has it, so it is there.
                let _ = feathers.insert(handle, feather);
                handle.clone()
            }
            None => feathers.add(feather),
        });
    }
    Some(worn)
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
