//! The groom's file: what goes out comes back, and what is damaged is named.

use bevy_plumage::asset::{AssetError, RonAsset};
use bevy_plumage::groom::*;
use plumage_tests::skins::*;

#[test]
fn text_comes_back_the_same() {
    let mut groom = groom();
    groom.regions[0].select = Select::Every(vec![
        Select::Tract(1),
        Select::Not(vec![Select::Joints(vec!["wing_L".into()])]),
    ]);
    let text = groom.to_ron().unwrap();
    assert_eq!(Groom::from_ron(text.as_bytes(), "made-up").unwrap(), groom);
}

#[test]
fn damage_is_named() {
    let damage: Vec<(&str, Box<dyn Fn(&mut Groom)>)> = vec![
        ("unit", Box::new(|g| g.unit = 0.0)),
        ("unit", Box::new(|g| g.unit = f32::NAN)),
        ("feathers[0]", Box::new(|g| g.feathers[0] = "".into())),
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
            "regions[0].segments.along",
            Box::new(|g| g.regions[0].segments.along = 0),
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
            "rows[0].stations[0].ride[0].weight",
            Box::new(|g| g.rows[0].stations[0].ride[0].weight = f32::NAN),
        ),
    ];
    for (field, harm) in damage {
        let mut groom = groom();
        harm(&mut groom);
        match groom.validate("birds/x.groom.ron") {
            Err(AssetError::Value {
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
fn another_version_is_named() {
    let mut groom = groom();
    groom.version = 9;
    let error = groom.validate("x.groom.ron").unwrap_err();
    assert!(
        matches!(&error, AssetError::Version { file, found: 9, oldest: 1, newest: 2, .. } if file == "x.groom.ron"),
        "{error}"
    );
    assert_eq!(
        groom.to_ron().unwrap_err().to_string(),
        error.to_string().replace("x.groom.ron", "made-up")
    );
}

#[test]
fn broken_text_gives_the_place() {
    let text = groom().to_ron().unwrap();
    for cut in (0..text.trim_end().len())
        .step_by(97)
        .filter(|cut| text.is_char_boundary(*cut))
    {
        assert!(
            matches!(
                Groom::from_ron(&text.as_bytes()[..cut], "x"),
                Err(AssetError::Syntax { .. })
            ),
            "cut at {cut}"
        );
    }
    let odd = text.replacen("unit:", "units:", 1);
    let Err(AssetError::Syntax { line, message, .. }) = Groom::from_ron(odd.as_bytes(), "x") else {
        panic!()
    };
    assert!(line > 1 && message.contains("units"), "{line}: {message}");
}
