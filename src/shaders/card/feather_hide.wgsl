// Cards of a bird that lie behind its skin: of the part of the screen where a card is, a grid knows how near the skin is, drawn by
// `feather_skin` (docs/book/lod.md#hidden-cards).
#import bevy_plumage::{
    feather_data as data,
    feather_lod_bindings as lods,
}

// Most texels in which a card is looked up.
const MOST_TEXELS: f32 = 4096.0;

@compute @workgroup_size(64)
fn clear(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < 4u) {
        atomicStore(&lods::grid[lods::BOUNDS + id.x], 0u);
    }
    atomicStore(&lods::grid[min(lods::FIRST_TEXEL + id.x, arrayLength(&lods::grid) - 1u)], 0u);
}

fn is_hidden(index: u32) -> bool {
    let at = index * lods::MEASURED;
    let bounds = clamp(lods::measured[at], vec4(-1.0), vec4(1.0));
    let nearest = bitcast<u32>(max(lods::measured[at + 1u].x, 0.0));
    let place = lods::texels(vec4(
        atomicLoad(&lods::grid[lods::BOUNDS]), atomicLoad(&lods::grid[lods::BOUNDS + 1u]),
        atomicLoad(&lods::grid[lods::BOUNDS + 2u]), atomicLoad(&lods::grid[lods::BOUNDS + 3u]),
    ));
    // One texel more all round: the skin has to cover the texels about the card's own, too, for what is known of each is its middle.
    let low = max(floor((bounds.xy - place.xy) * place.zw) - 1.0, vec2(0.0));
    let high = min(ceil((bounds.zw - place.xy) * place.zw) + 1.0, vec2(f32(lods::GRID)));
    let size = high - low;
    if (size.x < 1.0 || size.y < 1.0 || size.x * size.y > MOST_TEXELS) {
        return false;
    }
    let count = vec2<u32>(size);
    for (var y = 0u; y < count.y; y++) {
        for (var x = 0u; x < count.x; x++) {
            let there = vec2<u32>(low) + vec2(x, y);
            if (nearest >= atomicLoad(&lods::grid[lods::FIRST_TEXEL + there.y * lods::GRID + there.x])) {
                return false;
            }
        }
    }
    return true;
}

@compute @workgroup_size(64)
fn hide(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= lods::card_count()) {
        return;
    }
    var level = lods::lod[id.x];
    if (data::lod_class(level) != data::CARD_CULLED && is_hidden(id.x)) {
        level = data::CARD_HIDDEN;
        lods::lod[id.x] = level;
    }
    atomicAdd(&lods::grid[min(data::lod_class(level), data::CARD_HIDDEN)], 1u);
}
