// The triangles of a bird's cards, listed class by class by the layers of the cards, so that a pipeline draws those of its own class alone
// (docs/book/lod.md#lists).
#import bevy_plumage::feather_data as data

struct ListParams {
    card_count: u32,
    // Of the mesh.
    index_count: u32,
    // Its first index in `source`, in words.
    first_word: u32,
    // 1: two indices in a word.
    short_indices: u32,
    // 1: listed the other way round than `patches` says.
    turned: u32,
    // 1: cards that turn their backs to the eye are listed behind all others, the other way round than these.
    backs_last: u32,
}

const NOTHING: u32 = 0xffffffffu;
// Threads that arrange the lists.
const THREADS: u32 = 256u;
// Words of an indirect draw: number of indices, of instances, first index; the last two are written where it is recorded.
const DRAW_LENGTH: u32 = 5u;
// Words behind the lists for each card: where its indices begin in the first list that has them, and in the second.
const HEADS: u32 = 2u;
// In how many lists a card may be.
const MOST_LISTS: u32 = 2u;

@group(0) @binding(0) var<uniform> params: ListParams;
// By card: first vertex, number of them. By place in the mesh: card, its first index.
@group(0) @binding(1) var<storage, read> patches: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read> lod: array<u32>;
// Indices of the mesh.
@group(0) @binding(3) var<storage, read> source: array<u32>;
@group(0) @binding(4) var<storage, read_write> lists: array<u32>;
// One for each class, again for every pass of every camera.
@group(0) @binding(5) var<storage, read_write> draws: array<u32>;

// Indices up to each thread's places: of cards that show their fronts, and of those that are listed last.
var<workgroup> front_sums: array<vec4<u32>, THREADS>;
var<workgroup> back_sums: array<vec4<u32>, THREADS>;

fn card_count() -> u32 {
    return min(params.card_count, min(arrayLength(&lod) / data::LOD_WORDS, arrayLength(&patches)));
}

// Words of the lists.
fn room() -> u32 {
    return min((MOST_LISTS * params.index_count) >> params.short_indices, arrayLength(&lists));
}

fn source_word(word: u32) -> u32 {
    return source[min(params.first_word + word, arrayLength(&source) - 1u)];
}

// Whether the mesh lies the other way round than `patches` says, last triangle first.
fn is_turned() -> bool {
    let word = source_word(0u);
    let first = select(word, word & 0xffffu, params.short_indices != 0u);
    let range = patches[min(patches[0].z, card_count() - 1u)];
    return first < range.x || first >= range.x + range.y;
}

// A card in the mesh: its number, its first index, and how many it has.
struct Place {
    card: u32,
    first: u32,
    count: u32,
}

// The card that is listed at `place`. `turned`: see is_turned.
fn place_at(place: u32, turned: bool) -> Place {
    let last = card_count() - 1u;
    let at = select(place, last - place, params.turned != 0u);
    let first = min(patches[at].w, params.index_count);
    var end = params.index_count;
    if (at < last) {
        end = clamp(patches[at + 1u].w, first, params.index_count);
    }
    return Place(min(patches[at].z, last), select(first, params.index_count - end, turned), end - first);
}

// Whether a card is among those listed last.
fn is_last(place: Place) -> bool {
    return params.backs_last != 0u && data::lod_shows_back(lod[place.card]);
}

// Indices that each list has of a card.
fn shares_of(place: Place) -> vec4<u32> {
    return select(vec4(0u), vec4(place.count), data::lod_lists(lod[place.card]));
}

@compute @workgroup_size(256)
fn arrange(@builtin(local_invocation_index) thread: u32) {
    let turned = is_turned();
    let cards = card_count();
    let share = (cards + THREADS - 1u) / THREADS;
    let low = min(thread * share, cards);
    let high = min(low + share, cards);
    var fronts = vec4(0u);
    var backs = vec4(0u);
    for (var at = low; at < high; at++) {
        let place = place_at(at, turned);
        let last = is_last(place);
        fronts += select(shares_of(place), vec4(0u), last);
        backs += select(vec4(0u), shares_of(place), last);
    }
    front_sums[thread] = fronts;
    back_sums[thread] = backs;
    workgroupBarrier();
    for (var step = 1u; step < THREADS; step *= 2u) {
        var fronts_before = vec4(0u);
        var backs_before = vec4(0u);
        if (thread >= step) {
            fronts_before = front_sums[thread - step];
            backs_before = back_sums[thread - step];
        }
        workgroupBarrier();
        front_sums[thread] += fronts_before;
        back_sums[thread] += backs_before;
        workgroupBarrier();
    }
    let totals = front_sums[THREADS - 1u] + back_sums[THREADS - 1u];
    let firsts = vec4(0u, totals.x, totals.x + totals.y, totals.x + totals.y + totals.z);
    var next = firsts + front_sums[thread] - fronts;
    // From the end of each list on forwards.
    var end = firsts + totals - (back_sums[thread] - backs);
    for (var at = low; at < high; at++) {
        let place = place_at(at, turned);
        let shares = shares_of(place);
        let last = is_last(place);
        end -= select(vec4(0u), shares, last);
        let starts = select(next, end, vec4(last));
        next += select(shares, vec4(0u), last);
        var heads = vec2(NOTHING);
        for (var list = 0u; list < 4u; list++) {
            if (shares[list] > 0u) {
                heads = select(vec2(starts[list], NOTHING), vec2(heads.x, starts[list]), heads.x != NOTHING);
            }
        }
        let head = room() + HEADS * at;
        lists[head] = heads.x;
        lists[head + 1u] = heads.y;
    }
    for (var draw = thread; draw < arrayLength(&draws) / DRAW_LENGTH; draw += THREADS) {
        draws[DRAW_LENGTH * draw] = totals[draw % 4u];
        draws[DRAW_LENGTH * draw + 1u] = 1u;
        draws[DRAW_LENGTH * draw + 2u] = firsts[draw % 4u];
    }
}

@compute @workgroup_size(64)
fn fill(@builtin(global_invocation_id) id: vec3<u32>) {
    let cards = card_count();
    if (id.x >= cards) {
        return;
    }
    let place = place_at(id.x, is_turned());
    // A card has an even number of triangles: whole words.
    let half = params.short_indices;
    let words = place.count >> half;
    for (var head = 0u; head < HEADS; head++) {
        let first = lists[room() + HEADS * id.x + head];
        if (first == NOTHING) {
            continue;
        }
        let at = min(first >> half, room());
        for (var word = 0u; word < min(words, room() - at); word++) {
            lists[at + word] = source_word((place.first >> half) + word);
        }
    }
}
