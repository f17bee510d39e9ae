//! Any mutation of the kit's file gives a kit or an error that points into the file.

use proptest::prelude::*;
use ramp_kit::read_kit_str;
use std::sync::LazyLock;

static KIT: LazyLock<String> = LazyLock::new(|| {
    std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/kit.xml")).unwrap()
});

fn check(text: &str) {
    if let Err(error) = read_kit_str("kit.xml", text) {
        let (line, column) = error.place().line_column();
        assert!(line >= 1 && column >= 1 && line <= text.lines().count() + 1);
        assert!(!error.to_string().is_empty() && error.to_string().len() < 1000);
        let mut out = String::new();
        miette::NarratableReportHandler::new().render_report(&mut out, &error).unwrap();
    }
}

fn quoted(text: &str) -> Vec<(usize, usize)> {
    let quotes: Vec<usize> = text.match_indices('"').map(|(at, _)| at).collect();
    quotes.chunks_exact(2).map(|pair| (pair[0] + 1, pair[1])).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn text_is_put_in(at in 0.0..1.0f64, what in "\\PC{0,12}") {
        let mut at = (KIT.len() as f64 * at) as usize;
        while !KIT.is_char_boundary(at) { at -= 1; }
        check(&format!("{}{what}{}", &KIT[..at], &KIT[at..]));
    }

    #[test]
    fn text_is_cut_out(at in 0.0..1.0f64, length in 1usize..200) {
        let at = (KIT.len() as f64 * at) as usize;
        let bytes: Vec<u8> = KIT.bytes().enumerate().filter(|(i, _)| !(at..at + length).contains(i)).map(|(_, b)| b).collect();
        check(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn values_are_exchanged(one in any::<prop::sample::Index>(), other in any::<prop::sample::Index>()) {
        let values = quoted(&KIT);
        let (a, b) = (*one.get(&values), *other.get(&values));
        let (a, b) = if a.0 <= b.0 { (a, b) } else { (b, a) };
        prop_assume!(a != b);
        check(&[&KIT[..a.0], &KIT[b.0..b.1], &KIT[a.1..b.0], &KIT[a.0..a.1], &KIT[b.1..]].concat());
    }

    #[test]
    fn values_are_replaced(which in any::<prop::sample::Index>(), value in "[-0-9a-z.e+&;<]{0,9}") {
        let values = quoted(&KIT);
        let (from, to) = *which.get(&values);
        check(&[&KIT[..from], &value, &KIT[to..]].concat());
    }

    #[test]
    fn lines_are_dropped_or_repeated(at in any::<prop::sample::Index>(), count in 0usize..4) {
        let lines: Vec<&str> = KIT.lines().collect();
        let at = at.index(lines.len());
        let mut changed = lines[..at].to_vec();
        changed.extend(std::iter::repeat_n(lines[at], count));
        changed.extend(&lines[at + 1..]);
        check(&changed.join("\n"));
    }
}

#[test]
fn deep_and_wide_files_end() {
    check(&format!("<data>{}", "<beam>".repeat(90_000)));
    check(&format!("<data>{}{}</data>", "<beam>".repeat(40_000), "</beam>".repeat(40_000)));
    check(&format!("<data>{}</data>", "<beam/>".repeat(140_000)));
    check(&format!("<data><beam name=\"{}\"/></data>", "x".repeat(900_000)));
    check(&format!("<data><{}/></data>", "x".repeat(60_000)));
    check(&format!("<data><beam {}=\"\"/></data>", "x".repeat(60_000)));
    let joints: String = (0..9000)
        .map(|i| format!("<joint name=\"j{i}\" part=\"in-m-end\"><child link=\"j{i}\"/></joint>"))
        .collect();
    check(&format!("<data><beam name=\"b\">{joints}</beam></data>"));
}
