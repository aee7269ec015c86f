//! The groom's file: what goes out comes back, and what is damaged is named.

mod groom_common;

use bevy_plumage::groom::*;
use groom_common::*;

#[test]
fn text_comes_back_the_same() {
    let mut groom = groom();
    groom.regions[0].select = Select::Every(vec![
        Select::Tract(1),
        Select::Not(Box::new(Select::Joints(vec!["wing_L".into()]))),
    ]);
    let text = groom.to_ron("made-up").unwrap();
    assert_eq!(Groom::from_ron(&text, "made-up").unwrap(), groom);
}

#[test]
fn damage_is_named() {
    let damage: Vec<(&str, Box<dyn Fn(&mut Groom)>)> = vec![
        ("version", Box::new(|g| g.version = 9)),
        ("unit", Box::new(|g| g.unit = 0.0)),
        ("unit", Box::new(|g| g.unit = f32::NAN)),
        ("feathers[0]", Box::new(|g| g.feathers[0].clear())),
        ("regions[1].feather", Box::new(|g| g.regions[1].feather = 1)),
        (
            "regions[0].count",
            Box::new(|g| g.regions[0].count = u32::MAX),
        ),
        (
            "regions[0].width.1",
            Box::new(|g| g.regions[0].width.1 = -1.0),
        ),
        (
            "regions[0].length.0",
            Box::new(|g| g.regions[0].length.0 = f32::INFINITY),
        ),
        ("regions[0].camber", Box::new(|g| g.regions[0].camber = 0.9)),
        (
            "regions[0].segments.0",
            Box::new(|g| g.regions[0].segments.0 = 0),
        ),
        (
            "regions[0].placement.Rows",
            Box::new(|g| g.regions[0].placement = Placement::Rows(0)),
        ),
        (
            "regions[0].jitter.length",
            Box::new(|g| g.regions[0].jitter.length = 3.0),
        ),
        (
            "guides[0].points",
            Box::new(|g| g.guides[0].points.truncate(1)),
        ),
        (
            "guides[0].regions",
            Box::new(|g| g.guides[0].regions.push("nowhere".into())),
        ),
        ("rows[0].lengths", Box::new(|g| g.rows[0].lengths.clear())),
        (
            "rows[0].stations",
            Box::new(|g| g.rows[0].stations.truncate(1)),
        ),
        (
            "rows[0].stations[1].at",
            Box::new(|g| g.rows[0].stations[1].at = 0.0),
        ),
        (
            "rows[0].stations[0].direction",
            Box::new(|g| g.rows[0].stations[0].direction = [0.0; 3]),
        ),
        (
            "rows[0].stations[0].ride.wing_L",
            Box::new(|g| g.rows[0].stations[0].ride[0].1 = f32::NAN),
        ),
    ];
    for (field, harm) in damage {
        let mut groom = groom();
        harm(&mut groom);
        match groom.validate("birds/x.groom.ron") {
            Err(GroomError::Value {
                file, field: found, ..
            }) => {
                assert_eq!(found, field);
                assert_eq!(file, "birds/x.groom.ron");
            }
            other => panic!("{field}: {other:?}"),
        }
    }
}

#[test]
fn broken_text_gives_the_place() {
    let text = groom().to_ron("x").unwrap();
    for cut in (0..text.len())
        .step_by(97)
        .filter(|cut| text.is_char_boundary(*cut))
    {
        assert!(
            matches!(
                Groom::from_ron(&text[..cut], "x"),
                Err(GroomError::Parse { .. })
            ),
            "cut at {cut}"
        );
    }
    let odd = text.replacen("unit:", "units:", 1);
    let Err(GroomError::Parse { line, message, .. }) = Groom::from_ron(&odd, "x") else {
        panic!()
    };
    assert!(line > 1 && message.contains("units"), "{line}: {message}");
}
