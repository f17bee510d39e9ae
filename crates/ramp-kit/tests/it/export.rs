//! The whole export: its content, its reproducibility, and that it leaves other files alone.

use ramp_kit::export::{ExportError, File, export, files};
use ramp_kit::{Kit, bill, read_kit};
use std::path::Path;
use std::sync::LazyLock;

fn kit() -> Kit {
    read_kit(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/kit.xml")).unwrap()
}

/// All files of the whole kit.
fn whole() -> &'static [File] {
    static FILES: LazyLock<Vec<File>> = LazyLock::new(|| files(&kit()).unwrap());
    &FILES
}

#[test]
fn the_bill_is_the_published_one() {
    let kit = kit();
    let rows = bill::bill(&kit, &bill::printed(&kit).unwrap());
    let count = |part: &str| rows.iter().filter(|row| row.part == part).map(|row| row.count).sum::<usize>();
    for (part, expected) in [
        ("in-m-end", 10),
        ("in-m-end-feet", 4),
        ("thru-m", 4),
        ("in-f-end", 4),
        ("in-f", 2),
        ("thru-f", 4),
        ("angle-f", 5),
        ("peg", 15),
        ("holder", 5),
        ("extrusion 70", 10),
        ("extrusion 100", 2),
        ("extrusion 120", 10),
        ("extrusion 163.32", 2),
        ("screw M5 x 8, countersunk", 48),
        ("tag sticker", 33),
    ] {
        assert_eq!(count(part), expected, "{part}");
    }
    let csv = bill::csv(&rows);
    assert!(csv.lines().all(|line| line.matches('"').count() % 2 == 0));
    assert!(csv.contains("bought,\"screw M5 x 8, countersunk\",48,"));
    let lengths: usize = bill::cutting_list(&kit)
        .lines()
        .skip(1)
        .map(|line| line.split(',').nth(1).unwrap().parse::<usize>().unwrap())
        .sum();
    assert_eq!(lengths, 24);
}

#[test]
fn the_same_kit_gives_the_same_bytes() {
    let (a, b) = (whole(), files(&kit()).unwrap());
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(&b) {
        assert!(a == b, "{}", a.path);
    }
    let has = |path: &str| a.iter().any(|file| file.path == path);
    for path in [
        "sheet.pdf",
        "sheet.svg",
        "tags.pdf",
        "calibration.pdf",
        "guide.pdf",
        "stl/peg.stl",
        "3mf/angle-f.3mf",
    ] {
        assert!(has(path), "{path}");
    }
    assert!(has("plates/plate-01.3mf"));
}

#[test]
fn all_parts_lie_on_the_plates() {
    let mut copies = 0;
    for file in whole().iter().filter(|file| file.path.starts_with("plates/")) {
        let mut zip = zip::ZipArchive::new(std::io::Cursor::new(&file.bytes)).unwrap();
        let mut model = zip.by_name("3D/3dmodel.model").unwrap();
        let mut text = String::new();
        std::io::Read::read_to_string(&mut model, &mut text).unwrap();
        let document = roxmltree::Document::parse(&text).unwrap();
        assert_eq!(document.root_element().attribute("unit"), Some("millimeter"));
        let number = |node: roxmltree::Node<'_, '_>, name: &str| node.attribute(name).unwrap().parse::<f64>();
        let mut rectangles: Vec<[f64; 4]> = Vec::new();
        for item in document.descendants().filter(|node| node.has_tag_name("item")) {
            let id = item.attribute("objectid");
            let object = document
                .descendants()
                .find(|node| node.has_tag_name("object") && node.attribute("id") == id)
                .unwrap();
            let numbers: Vec<f64> =
                item.attribute("transform").unwrap().split(' ').map(|n| n.parse().unwrap()).collect();
            let mut rectangle = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
            let mut lowest = f64::INFINITY;
            for vertex in object.descendants().filter(|node| node.has_tag_name("vertex")) {
                let [x, y, z] = [("x", 9), ("y", 10), ("z", 11)]
                    .map(|(name, at)| number(vertex, name).unwrap() + numbers[at]);
                rectangle =
                    [rectangle[0].min(x), rectangle[1].max(x), rectangle[2].min(y), rectangle[3].max(y)];
                lowest = lowest.min(z);
            }
            assert!(lowest.abs() < 1e-3, "{}", file.path);
            assert!(rectangle[0] >= 0.0 && rectangle[1] <= 256.0, "{}: {rectangle:?}", file.path);
            assert!(rectangle[2] >= 0.0 && rectangle[3] <= 256.0, "{}: {rectangle:?}", file.path);
            for other in &rectangles {
                let apart = rectangle[1] < other[0]
                    || other[1] < rectangle[0]
                    || rectangle[3] < other[2]
                    || other[3] < rectangle[2];
                assert!(apart, "{}", file.path);
            }
            rectangles.push(rectangle);
            copies += 1;
        }
    }
    assert_eq!(copies, 33 + 15 + 5 + 2 + 1);
}

#[test]
fn it_overwrites_only_what_it_wrote() {
    // Two beams are enough here: each export cuts all its solids anew.
    let whole = kit();
    let kit = Kit { beams: whole.beams[..2].to_vec(), ..whole };
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("parts");
    let written = export(&kit, &out, false).unwrap();
    assert!(written.iter().all(|file| file.is_file()));
    // Again, unchanged.
    export(&kit, &out, false).unwrap();
    // Another kit, over files that nobody touched.
    let other = Kit { beams: kit.beams[..1].to_vec(), ..kit.clone() };
    export(&other, &out, false).unwrap();
    // A changed file, and one that was there before.
    std::fs::write(out.join("bill-of-parts.md"), "my own notes").unwrap();
    match export(&kit, &out, false) {
        Err(ExportError::Foreign { files }) => assert_eq!(files, [out.join("bill-of-parts.md")]),
        other => panic!("{:?}", other.is_ok()),
    }
    assert_eq!(std::fs::read_to_string(out.join("bill-of-parts.md")).unwrap(), "my own notes");
    assert!(export(&kit, &out, false).unwrap_err().to_string().contains("bill-of-parts.md"));
    export(&kit, &out, true).unwrap();
    assert!(std::fs::read_to_string(out.join("bill-of-parts.md")).unwrap().starts_with("# Bill"));
    // A folder where a file should be.
    let blocked = folder.path().join("file");
    std::fs::write(&blocked, "x").unwrap();
    assert!(matches!(
        export(&kit, &blocked, false),
        Err(ExportError::Foreign { .. } | ExportError::Write { .. })
    ));
}
