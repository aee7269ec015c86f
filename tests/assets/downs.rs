//! `*.down.ron`: every file in the repository is read, and a damaged one is refused with its file, field, value and range.

use bevy_plumage::asset::{AssetError, RonAsset};
use bevy_plumage::undercoat::{Coat, Down};

fn read(text: &str) -> Result<Down, AssetError> {
    Down::from_ron(text.as_bytes(), "a.down.ron")
}

#[test]
fn the_files_of_the_repository_are_read_and_written_alike() {
    let mut count = 0;
    for entry in std::fs::read_dir(plumage_tests::asset("downs")).unwrap() {
        let path = entry.unwrap().path();
        let bytes = std::fs::read(&path).unwrap();
        let down = Down::from_ron(&bytes, &path.display().to_string()).unwrap();
        let again = read(&down.to_ron().unwrap()).unwrap();
        assert_eq!(down, again);
        count += 1;
    }
    assert!(count >= 4, "{count} files");
}

#[test]
fn a_file_may_leave_everything_out() {
    assert_eq!(read("(version: 2)").unwrap(), Down::default());
}

#[test]
fn damaged_files_are_refused_with_what_is_wrong() {
    for (text, expected) in [
        ("", "a.down.ron:1:1:"),
        ("(version: 2, thickness_mm: )", "a.down.ron:1:27:"),
        ("(version: 2, thickness: 4.0)", "thickness"),
        (
            "(version: 7)",
            "a.down.ron: format version 7, this crate reads 1 to 2",
        ),
        (
            "(version: 2, thickness_mm: 0.0)",
            "a.down.ron: `thickness_mm` is 0, allowed is 0.2 to 60",
        ),
        (
            "(version: 2, optical_depth: NaN)",
            "a.down.ron: `optical_depth` is NaN, allowed is 0 to 12",
        ),
        (
            "(version: 2, color: (0.1, 2.0, 0.1))",
            "a.down.ron: `color[1]` is 2, allowed is 0 to 1",
        ),
        (
            "(version: 2, tile: (64, 64, 1000000))",
            "a.down.ron: `tile[2]` is 1000000, allowed is 4 to 256",
        ),
        (
            "(version: 2, coats: [(hairs: 10, radius: (low: 0.5, high: 0.2), length: (low: 0.1, high: 0.2), curl: 1.0)])",
            "a.down.ron: `coats[0].radius.high` is 0.2, allowed is 0.5 to 4",
        ),
    ] {
        let error = read(text).unwrap_err().to_string();
        assert!(error.contains(expected), "{text}: {error}");
    }
}

#[test]
fn a_damaged_down_is_not_written() {
    let hairs = Coat {
        hairs: 30_000,
        ..Coat::default()
    };
    let mut down = Down::default();
    down.coats = vec![hairs];
    let error = down.to_ron().unwrap_err();
    assert!(matches!(error, AssetError::Value { ref field, .. } if field == "coats[0].hairs"));
}
