//! What light costs a distant fragment, counted without a GPU: a change that adds operations has to say so here.

use bevy_plumage::maths::{query::*, scattering::*};
use plumage_reference::fibre_traced::uniform;
use plumage_tests::{
    cases::on_sphere,
    counted::{Counted, operations},
};
use rand_pcg::Pcg64Mcg;

fn counted<const N: usize>(values: [f64; N]) -> [Counted; N] {
    values.map(Counted)
}

/// The default vane, radii and periods of a contour feather.
fn vane() -> Vane<Counted> {
    let [p_b, d_bl, alpha_b, alpha_bl, r_b, r_bd, r_bp] =
        counted([0.008, 0.001, 0.8, 0.9, 0.001, 2.5e-4, 2.5e-4]);
    Vane::new(p_b, d_bl, alpha_b, alpha_bl, r_b, r_bd, r_bp)
}

fn mirrors(table: &FibreTable) -> [MirrorPlace<Counted>; 2] {
    let MirrorPlace { blur, retreat } = mirror_place(table);
    [MirrorPlace {
        blur: Counted(blur),
        retreat: Counted(retreat),
    }; 2]
}

/// The fibre's head and rows, as the shader reads them.
type Packed = ([[Counted; 4]; SHORT_HEAD_VEC4S], Vec<ShortRow<Counted>>);

fn packed(table: &FibreTable) -> Packed {
    let all: Vec<[Counted; 4]> = table
        .pack_short()
        .iter()
        .map(|v| counted(v.map(f64::from)))
        .collect();
    let (head, rows) = all.split_at(SHORT_HEAD_VEC4S);
    (
        std::array::from_fn(|i| head[i]),
        rows.as_chunks::<SHORT_ROW_VEC4S>().0.to_vec(),
    )
}

/// Light of one sun from three parts of a vane, in three channels, as MEAN cards find it in every fragment and LIT ones at their vertices;
/// without geometry of the card, coverage, maps of shadow and sky.
fn fragment((head, rows): &Packed, mirrors: [MirrorPlace<Counted>; 2], random: &mut Pcg64Mcg) {
    let directions = [(); 2].map(|()| counted(on_sphere(random).map(f64::from)));
    let albedo = counted([(); 3].map(|()| uniform(random)));
    let eye = vane_eye(&vane(), directions[0], mirrors);
    let ray = vane_ray(&eye, directions[1]);
    let reached = vane_shadow(&eye, &ray);
    for (part, light) in reached.iter().enumerate().skip(1) {
        let (sine, cosine) = [(0.7, 0.7), (0.2, 0.98), (0.9, 0.4)][part - 1];
        let [own_eye, own_light] = directions.map(|[x, y, z]| {
            let [sine, cosine] = counted([sine, cosine]);
            [x * sine + y * cosine, y * sine - x * cosine, z]
        });
        let across = own_eye[1] * own_eye[1] + own_eye[2] * own_eye[2];
        let (i, fraction) = fibre_row_at(num_traits::Float::sqrt(across));
        let row = short_row_step(&rows[2 * i], &rows[2 * i + 1], fraction, false);
        let shading = short_shading(head, &row, own_eye, Counted(0.0));
        let lobes = short_lobes(&shading, own_light);
        let reach = FibreReach {
            mirror: light.mirror,
            even: light.even,
            along: light.along,
            place: light.place,
        };
        for albedo in albedo {
            let color = short_color(&shading, inner_albedo(albedo, Counted(0.5)), Counted(0.0));
            let scattered = shading.energy[1] * color.second + shading.energy[2] * color.scattered;
            let [spread, cone] = short_again(scattered, scattered, Counted(0.5), Counted(0.0));
            let _ = cone * short_lit(&shading, &color, &lobes, &reach) + spread;
        }
    }
}

#[test]
fn a_distant_fragment_asks_its_fibres_in_so_many_operations() {
    let mut random = Pcg64Mcg::new(7);
    for (kind, most) in [
        (Fibre::default().kind, 3600),
        (FibreKind::Structural { core_radius: 0.7 }, 2900),
    ] {
        let table = FibreTable::build(&Fibre {
            kind,
            ..Fibre::default()
        });
        let (packed, mirrors) = (packed(&table), mirrors(&table));
        let counts: Vec<u64> = (0..4000)
            .map(|_| operations(|| fragment(&packed, mirrors, &mut random)).1)
            .collect();
        let mean = counts.iter().sum::<u64>() / counts.len() as u64;
        let worst = counts.iter().max().copied().unwrap_or_default();
        println!("{kind:?}: {mean} operations, at most {worst}");
        assert!(worst <= most, "{kind:?}: {worst}");
    }
}
