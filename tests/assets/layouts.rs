//! What Rust packs is what the shaders read: uniforms, constants, cards and feathers.

use bevy::math::Vec3;
use bevy_plumage::{
    anatomy::Side,
    groom::Card,
    maths::query::vane_shape,
    render::{
        layout as feathers,
        pack::{TableCache, pack_cards, pack_feathers},
    },
    undercoat::layout as undercoat,
};
use plumage_tests::gpu;

fn shader(file: &str) -> String {
    gpu::shader_source(file.rsplit('/').next().unwrap_or(file))
}

/// Every struct of uniforms that Rust fills.
#[test]
fn uniforms_are_laid_out_as_the_shaders_read_them() {
    let mut layouts = feathers::struct_layouts();
    layouts.extend(undercoat::struct_layouts());
    assert!(layouts.len() >= 5, "{layouts:?}");
    for layout in layouts {
        let source = shader(layout.file);
        let start = source
            .find(&format!("struct {} {{", layout.name))
            .unwrap_or_else(|| panic!("{}: no struct {}", layout.file, layout.name));
        let end = start + source[start..].find('}').unwrap() + 1;
        let module = naga::front::wgsl::parse_str(&source[start..end])
            .unwrap_or_else(|e| panic!("{}: {}", layout.file, e.emit_to_string(&source)));
        let (_, found) = module
            .types
            .iter()
            .find(|(_, ty)| ty.name.as_deref() == Some(layout.name))
            .unwrap();
        let naga::TypeInner::Struct { members, span } = &found.inner else {
            panic!("{} is no struct", layout.name);
        };
        let members: Vec<_> = members
            .iter()
            .map(|m| (m.name.as_deref().unwrap_or(""), u64::from(m.offset)))
            .collect();
        assert_eq!(members, layout.fields, "{} of {}", layout.name, layout.file);
        assert_eq!(u64::from(*span), layout.size, "size of {}", layout.name);
    }
}

/// Every `struct` behind a `var<uniform>` of our own is among those that are compared.
#[test]
fn no_uniform_is_left_out() {
    let mut known: Vec<_> = feathers::struct_layouts();
    known.extend(undercoat::struct_layouts());
    let bevys = ["View", "Globals"];
    let mut seen = 0;
    for room in ["maths", "card", "undercoat", "comparison"] {
        let folder = plumage_tests::root().join("src/shaders").join(room);
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let source = std::fs::read_to_string(&path).unwrap();
            for line in source.lines().filter(|line| line.contains("var<uniform>")) {
                let name = line
                    .rsplit(':')
                    .next()
                    .unwrap()
                    .trim()
                    .trim_end_matches(';');
                seen += 1;
                assert!(
                    bevys.contains(&name) || known.iter().any(|layout| layout.name == name),
                    "{}: {name}",
                    path.display()
                );
            }
        }
    }
    assert!(seen >= 7, "{seen}");
}

#[test]
fn constants_are_those_of_the_packing() {
    let mut constants = feathers::constant_layouts();
    constants.extend(undercoat::constant_layouts());
    for constant in constants {
        let source = shader(constant.file);
        let head = format!("const {}: u32 = ", constant.name);
        let value = source
            .lines()
            .find_map(|line| line.strip_prefix(&head))
            .unwrap_or_else(|| panic!("{}: no constant {}", constant.file, constant.name))
            .split("u;")
            .next()
            .and_then(|text| text.parse::<u32>().ok());
        assert_eq!(
            value,
            Some(constant.value),
            "{} of {}",
            constant.name,
            constant.file
        );
    }
}

fn card(i: u16) -> Card {
    let t = f32::from(i);
    let turn = |k: f32| (t * k + 0.5).sin();
    let normal = Vec3::new(turn(0.7), turn(1.3), turn(0.4)).normalize_or(Vec3::Z);
    Card {
        root: Vec3::new(turn(0.11), -2.5 + t, 1e-3 * t),
        along: normal.any_orthonormal_vector(),
        normal,
        center: Vec3::new(t, turn(0.3), -t),
        radius: 0.01 + 0.002 * t,
        length: 0.04 + 0.001 * t,
        width: 0.01 + 0.0005 * t,
        joints: [i, 65_535 - i, 7 * i, 256 + i],
        weights: [0.5, 0.25, 0.15, 0.1],
        feather: 513 + i,
        turn: 0.1 * (i % 7) as f32,
        mirrored: i % 2 == 1,
        region: i % 128,
        layer: 3.0 + 0.5 * t,
        tint: [turn(0.2).abs(), turn(0.9).abs(), 1.0 - 0.01 * t],
        seed: 0x9e37_79b9u32.wrapping_mul(u32::from(i) + 1),
    }
}

#[test]
fn a_packed_card_makes_the_round_trip() {
    const VALUES: usize = 31;
    let text = "#import bevy_plumage::feather_data as data
        fn words(at: u32) -> vec4<u32> {
            return bitcast<vec4<u32>>(vec4(input[at], input[at + 1u], input[at + 2u], input[at + 3u]));
        }
        fn evaluate(i: u32) {
            let at = 4u * data::CARD_LENGTH * i;
            let card = data::card_decode(words(at), words(at + 4u), words(at + 8u), words(at + 12u), words(at + 16u));
            let bits = card.feather;
            let values = array<f32, 31>(
                card.root.x, card.root.y, card.root.z, card.length,
                card.center.x, card.center.y, card.center.z, card.radius,
                card.along.x, card.along.y, card.along.z, card.width,
                f32(card.joints.x), f32(card.joints.y), f32(card.joints.z), f32(card.joints.w),
                card.weights.x, card.weights.y, card.weights.z, card.weights.w,
                f32(data::card_feather(bits)), f32((bits >> 16u) & 1u), f32(data::card_region(bits)), data::card_layer(bits),
                f32(card.seed & 0xffffu), f32(card.seed >> 16u),
                card.normal.x, card.normal.y, card.normal.z,
                dot(data::card_tint(card.tint), vec3(1.0, 10.0, 100.0)), data::card_turn(card.tint),
            );
            for (var j = 0u; j < 31u; j++) { output[31u * i + j] = values[j]; }
        }";
    let cards: Vec<Card> = (0..100).map(card).collect();
    let bytes = pack_cards(&cards);
    let input: Vec<f32> = bytes
        .as_chunks::<4>()
        .0
        .iter()
        .map(|b| f32::from_le_bytes(*b))
        .collect();
    let count = cards.len();
    let Some(found) = gpu::run(&["feather_data.wgsl"], text, &input, count, VALUES * count) else {
        return;
    };
    let (low, high) = (cards[0].layer, cards[count - 1].layer);
    for (card, found) in cards.iter().zip(found.chunks(VALUES)) {
        // Places and sizes come back to the bit, small numbers exactly.
        let mut exact: Vec<f32> = Vec::new();
        exact.extend(card.root.to_array());
        exact.push(card.length);
        exact.extend(card.center.to_array());
        exact.push(card.radius);
        exact.extend(card.along.to_array());
        exact.push(card.width);
        exact.extend(card.joints.map(f32::from));
        assert_eq!(found[..16], exact[..], "{card:?}");
        for (weight, wanted) in found[16..20].iter().zip(card.weights) {
            assert!((weight - wanted).abs() < 1.0 / 65_000.0, "{card:?}");
        }
        let flags = [card.feather, u16::from(card.mirrored), card.region].map(f32::from);
        assert_eq!(found[20..23], flags, "{card:?}");
        let layer = (card.layer - low) / (high - low);
        assert!((found[23] - layer).abs() <= 1.0 / 254.0, "{card:?}");
        let seed = [card.seed & 0xffff, card.seed >> 16].map(|half| half as f32);
        assert_eq!(found[24..26], seed, "{card:?}");
        let normal = Vec3::new(found[26], found[27], found[28]);
        assert!((normal - card.normal).length() < 1e-4, "{card:?} {normal}");
        // Tints are ten bits of a square root.
        let tint = card.tint[0] + 10.0 * card.tint[1] + 100.0 * card.tint[2];
        assert!((found[29] - tint).abs() < 111.0 * 2.0 / 1023.0, "{card:?}");
        // How far it turns is one of four bounds.
        let bounds = [5.0, 10.0, 20.0, 40.0];
        let bound = bounds
            .into_iter()
            .find(|bound| card.turn.to_degrees() <= *bound);
        assert_eq!(found[30], bound.unwrap_or(40.0), "{card:?}");
    }
}

#[test]
fn a_packed_feather_makes_the_round_trip() {
    const VALUES: usize = 48;
    let text = "#import bevy_plumage::feather_data as data
        fn row(at: u32) -> vec4<f32> {
            return vec4(input[4u * at], input[4u * at + 1u], input[4u * at + 2u], input[4u * at + 3u]);
        }
        fn evaluate(i: u32) {
            let base = data::FEATHERS_BASE + i * data::FEATHER_STRIDE;
            let shape = row(base + data::SHAPE);
            let sheen = row(base + data::SHEEN);
            var values = array<f32, 48>();
            for (var side = 0u; side < 2u; side++) {
                let slot = base + select(data::LEFT_VANE, data::RIGHT_VANE, side == 1u);
                let rest = row(slot + 2u);
                let vane = data::vane_unpack(row(slot), row(slot + 1u), rest);
                let all = array<f32, 11>(vane.p_b, vane.d_bl, vane.cos_b, vane.sin_b, vane.cos_bl, vane.sin_bl, vane.r_b, vane.r_bd,
                    vane.r_bp, rest.y, rest.z);
                for (var j = 0u; j < 11u; j++) { values[11u * side + j] = all[j]; }
                let shape = data::shape_unpack(row(slot), row(slot + 1u), rest, row(slot + 3u), row(slot + 4u));
                let known = array<f32, 8>(shape.per_barb, shape.per_barbule, shape.barb, shape.distal.radius, shape.proximal.inverse,
                    shape.proximal.ratio, shape.kappa, shape.e_root);
                for (var j = 0u; j < 8u; j++) { values[32u + 8u * side + j] = known[j]; }
            }
            values[22] = shape.x;
            values[23] = shape.y;
            values[24] = shape.z;
            values[25] = sheen.x;
            values[26] = sheen.y;
            values[27] = row(base + data::PARTS).x;
            values[28] = row(base + data::PARTS + 1u).x;
            values[29] = row(base + data::HEADER_LENGTH).z;
            values[30] = row(base + data::HEADER_LENGTH + data::RACHIS_SAMPLES + 100u).y;
            values[31] = row(0u).x;
            for (var j = 0u; j < 48u; j++) { output[48u * i + j] = values[j]; }
        }";
    let feathers = ["contour", "primary"].map(plumage_tests::shipped::feather);
    let bytes = pack_feathers(&[&feathers[0], &feathers[1]], &mut TableCache::default());
    let input: Vec<f32> = bytes
        .as_chunks::<4>()
        .0
        .iter()
        .map(|b| f32::from_le_bytes(*b))
        .collect();
    let Some(found) = gpu::run(&["feather_data.wgsl"], text, &input, 2, 2 * VALUES) else {
        return;
    };
    for (feather, found) in feathers.iter().zip(found.chunks(VALUES)) {
        let table = feather.shape_table();
        let mut wanted: Vec<f32> = Vec::new();
        for side in Side::BOTH {
            let card = feather.card_vane::<f32>(side);
            let v = card.vane;
            wanted.extend([
                v.p_b,
                v.d_bl,
                v.cos_b,
                v.sin_b,
                v.cos_bl,
                v.sin_bl,
                v.r_b,
                v.r_bd,
                v.r_bp,
                card.fringe,
                card.downy,
            ]);
        }
        wanted.extend([feather.aspect, feather.length_mm * 1e-3, table.start]);
        wanted.extend([
            feather.optics.sheen.strength,
            feather.optics.sheen.roughness,
        ]);
        wanted.extend([feather.albedo.share.rachis, feather.albedo.share.barb]);
        wanted.extend([table.rachis[0][2], table.contour[100][1], 2.0]);
        for side in Side::BOTH {
            let shape = vane_shape(&feather.card_vane::<f32>(side).vane);
            let [distal, proximal] = shape.families;
            wanted.extend([shape.per_barb, shape.per_barbule, shape.barb]);
            wanted.extend([distal.radius, proximal.inverse, proximal.ratio]);
            wanted.extend([shape.kappa, shape.e_root]);
        }
        assert_eq!(found, wanted);
    }
}
