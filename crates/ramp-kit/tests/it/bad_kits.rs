//! Every defect of a kit file gives one message at its place.

use ramp_kit::{KitError, KitProblem, read_kit, read_kit_str};
use std::path::Path;

const KIT: &str = r#"<data>
  <beam name="b1">
    <joint name="b1j1" part="in-m-end" marker="1">
      <child link="b1l1"/>
    </joint>
    <joint name="b1j2" part="in-f" opens="right">
      <parent link="b1l1"/>
      <child link="b1l2"/>
    </joint>
    <joint name="b1j3" part="in-f-end" marker="2">
      <parent link="b1l2"/>
    </joint>
    <link name="b1l1" length="120">
      <parent joint="b1j1"/>
      <child joint="b1j2"/>
    </link>
    <link name="b1l2" length="100">
      <parent joint="b1j2"/>
      <child joint="b1j3"/>
    </link>
    <start x="11" y="22" flipped="True"/>
  </beam>
  <holder name="h1" x="100" y="200"/>
  <peg name="p1" marker="19" holder="h1" slot="-1"/>
  <peg name="p2" marker="20" holder="h1" slot="0"/>
  <sheet width="594" height="420" x="53" y="600"/>
</data>
"#;

/// Reads the kit with its first `from` replaced by `to`.
#[track_caller]
fn broken(from: &str, to: &str) -> KitError {
    assert!(KIT.contains(from), "{from}");
    let text = KIT.replacen(from, to, 1);
    match read_kit_str("kit.xml", &text) {
        Err(error) => error,
        Ok(_) => panic!("this kit was accepted"),
    }
}

/// Checks `file:line:column: sentence (help)`.
#[track_caller]
fn says(error: &KitError, expected: &str) {
    assert_eq!(format!("{error:#}"), format!("kit.xml:{expected}"));
}

#[test]
fn the_kit_itself_is_right() {
    read_kit_str("kit.xml", KIT).unwrap();
}

#[test]
fn broken_xml() {
    let error = broken("</beam>", "</bean>");
    says(&error, "22:3: this is not valid XML: expected 'beam' tag, not 'bean'");
    let error = broken("<data>\n", "<data>\n<!DOCTYPE x [<!ENTITY a \"b\">]>");
    assert!(error.to_string().starts_with("this is not valid XML"), "{error}");
    let error = read_kit_str("kit.xml", "").err().unwrap();
    assert_eq!(error.location(), "kit.xml:1:1");
    let error = read_kit_str("kit.xml", "<kit/>").err().unwrap();
    says(&error, "1:1: found the outermost element <kit>, expected <data>");
    let error = read_kit_str("kit.xml", "<data/>").err().unwrap();
    says(&error, "1:1: this kit has no beams");
}

#[test]
fn files_that_cannot_be_read() {
    let error = read_kit(Path::new("no/such/kit.xml")).err().unwrap();
    assert_eq!(format!("{error:#}"), "cannot read no/such/kit.xml: there is no such file");
    assert_eq!(error.location(), "no/such/kit.xml");
    let folder = tempfile::tempdir().unwrap();
    let error = read_kit(folder.path()).err().unwrap();
    assert!(error.to_string().ends_with(": it is a folder"), "{error}");
    let path = folder.path().join("latin.xml");
    std::fs::write(&path, b"<data>\n  <beam name=\"b\xe9\"/>\n</data>").unwrap();
    let error = read_kit(&path).err().unwrap();
    assert_eq!(error.to_string(), "this file is not UTF-8 text: found the byte 0xe9");
    assert!(error.location().ends_with("latin.xml:2:16"), "{}", error.location());
    let path = folder.path().join("large.xml");
    std::fs::write(&path, vec![b' '; ramp_kit::source::MAX_FILE + 1]).unwrap();
    let error = read_kit(&path).err().unwrap();
    assert!(error.to_string().ends_with("this file is larger than 1024 kB"), "{error}");
}

#[test]
fn unknown_elements_and_attributes() {
    says(
        &broken("<holder name", "<holdr name"),
        "23:3: found <holdr> inside <data>, expected <beam>, <peg>, <holder>, <sheet>, <base>, <part>, <dimensions> (did you mean <holder>?)",
    );
    says(
        &broken("part=\"in-m-end\"", "prat=\"in-m-end\""),
        "3:24: <joint> has no attribute `prat` (did you mean `part`?)",
    );
    says(&broken(" slot=\"-1\"", ""), "24:3: <peg> has no attribute `slot`, which it needs");
    says(&broken(" name=\"b1l1\"", ""), "13:5: <link> has no attribute `name`, which it needs");
    // Attributes of other tools are ignored.
    assert!(read_kit_str("kit.xml", &KIT.replace("<link ", "<link colour=\"red\" ")).is_ok());
}

#[test]
fn joint_types() {
    says(
        &broken("\"in-m-end\"", "\"in-m-ned\""),
        "3:30: there is no joint type `in-m-ned` (did you mean `in-m-end`?)",
    );
    says(
        &broken("\"in-m-end\"", "\"hinge\""),
        "3:30: there is no joint type `hinge` (the types are in-m-end, in-m-end-feet, thru-m, in-f-end, in-f, thru-f, angle-f)",
    );
    says(
        &broken("\"in-m-end\"", "\"thru-m\""),
        "3:30: `b1j1` is a `thru-m`, which cannot be at the end of a beam",
    );
    says(
        &broken("\"in-f\"", "\"in-f-end\""),
        "6:30: `b1j2` is a `in-f-end`, which cannot be in the middle of a beam",
    );
    says(&broken("\"right\"", "\"Right\""), "6:43: found opens=\"Right\", expected left or right");
    says(&broken("marker=\"1\"", "opens=\"left\""), "3:47: a `in-m-end` has no opening to one side");
}

#[test]
fn bad_numbers() {
    for bad in ["NaN", "-120", "1e9", "inf", "12O", "", "0"] {
        says(
            &broken("\"120\"", &format!("\"{bad}\"")),
            &format!("13:31: found length=\"{bad}\", expected a number from 1 to 2000 mm"),
        );
    }
    says(
        &broken("x=\"100\"", "x=\"1e300\""),
        "23:24: found x=\"1e300\", expected a number from -5000 to 5000 mm",
    );
    let family = "the family tag25h9 has the ids 0 to 34, and 0 is on the sheet";
    says(&broken("\"19\"", "\"35\""), &format!("24:26: there is no tag 35: {family}"));
    says(&broken("\"19\"", "\"0\""), &format!("24:26: there is no tag 0: {family}"));
    says(&broken("\"-1\"", "\"2\""), "24:48: found slot=\"2\", expected a whole number from -1 to 1");
    says(&broken("\"True\"", "\"true\""), "21:35: found flipped=\"true\", expected True or False");
    says(
        &broken("\"120\"", "\"40\""),
        "13:31: the link `b1l1` is 40 mm long, expected at least 67.05 mm between these two joints",
    );
}

#[test]
fn a_name_is_no_path_no_formula_no_option_and_not_endless() {
    let long = "b".repeat(65);
    // The name in the kit, and its form in the message.
    let names = [
        ("", ""),
        ("b 1", "b 1"),
        ("..", ".."),
        (".b1", ".b1"),
        ("-b1", "-b1"),
        ("../../b1", "../../b1"),
        ("/b1", "/b1"),
        ("=b1", "=b1"),
        ("b1&#10;b2", "b1\\nb2"),
        ("b1\u{9b}2J", "b1\\u{9b}2J"),
        ("b1\u{202e}", "b1\\u{202e}"),
        ("bé", "bé"),
        (long.as_str(), &format!("{}…", "b".repeat(64))),
    ];
    for (name, shown) in names {
        let error = broken("\"b1\"", &format!("\"{name}\""));
        says(&error, &format!("2:15: found the name \"{shown}\", expected {}", ramp_kit::source::A_NAME));
    }
    // Pegs, holders, joints, links and joint types follow the same rule.
    for name in ["p1", "h1", "b1j1", "b1l1"] {
        let error = broken(&format!("name=\"{name}\""), "name=\"a/b\"");
        assert!(error.to_string().starts_with("found the name \"a/b\", expected 1 to 64"), "{name}: {error}");
    }
}

#[test]
fn names_and_tags_are_used_once() {
    says(&broken("\"p2\"", "\"p1\""), "25:14: the name `p1` is used twice");
    says(&broken("\"h1\" x", "\"b1l1\" x"), "23:17: the name `b1l1` is used twice");
    says(&broken("\"20\"", "\"19\""), "25:26: the tag 19 is used twice");
    says(&broken("\"19\"", "\"2\""), "24:26: the tag 2 is used twice");
    says(
        &broken("<peg name=\"p2\"", "<sheet/><peg name=\"p2\""),
        "25:3: <sheet> has no attribute `width`, which it needs",
    );
    says(
        &broken("</data>", "<sheet width=\"1\" height=\"1\" x=\"0\" y=\"0\"/></data>"),
        "27:1: <sheet> occurs twice",
    );
}

#[test]
fn pegs() {
    says(
        &broken("holder=\"h1\" slot=\"0\"", "holder=\"h2\" slot=\"0\""),
        "25:38: there is no holder `h2` (did you mean `h1`?)",
    );
    says(&broken("slot=\"0\"", "slot=\"-1\""), "25:48: slot -1 of `h1` is used twice");
}

#[test]
fn a_child_that_names_itself() {
    // The published file has this in its b2j1.
    says(
        &broken("<child link=\"b1l1\"/>", "<child link=\"b1j1\"/>"),
        "4:20: `b1j1` names `b1j1` as its child, expected a link of b1 (did you mean `b1l1`?)",
    );
}

#[test]
fn a_parent_that_names_a_joint() {
    // The published file has this in its b5j3.
    says(
        &broken("<parent link=\"b1l2\"/>", "<parent link=\"b1j2\"/>"),
        "11:21: `b1j3` names `b1j2` as its parent, expected a link of b1 (did you mean `b1l2`?)",
    );
}

#[test]
fn chains_that_loop_branch_or_break() {
    // Two elements <child>.
    says(
        &broken("<child link=\"b1l1\"/>", "<child link=\"b1l1\"/><child link=\"b1l2\"/>"),
        "4:27: `b1j1` has two elements <child>",
    );
    // Two joints with the same child link.
    says(
        &broken("<child link=\"b1l1\"/>", "<child link=\"b1l2\"/>"),
        "4:20: `b1j1` names `b1l2` as its child, but `b1l2` does not name `b1j1` in return",
    );
    says(&broken("<parent joint=\"b1j1\"/>", ""), "13:5: the link `b1l1` has no <parent>");
    says(
        &broken("<parent link=\"b1l1\"/>", ""),
        "15:21: `b1l1` names `b1j2` as its child, but `b1j2` does not name `b1l1` in return",
    );
    // Joints 2 and 3 form a ring of their own.
    let ring = KIT
        .replacen("<child link=\"b1l1\"/>", "", 1)
        .replacen("<parent joint=\"b1j1\"/>", "<parent joint=\"b1j3\"/>", 1)
        .replacen("<parent link=\"b1l2\"/>", "<parent link=\"b1l2\"/><child link=\"b1l1\"/>", 1);
    let error = read_kit_str("kit.xml", &ring).err().unwrap();
    says(&error, "6:5: b1 falls apart: `b1j2` is not connected with `b1j1`");
    // All three form one.
    let ring = KIT
        .replacen("<child link=\"b1l1\"/>", "<parent link=\"x\"/><child link=\"b1l1\"/>", 1)
        .replacen("<parent link=\"b1l2\"/>", "<parent link=\"b1l2\"/><child link=\"x\"/>", 1)
        .replacen(
            "<start",
            "<link name=\"x\" length=\"100\"><parent joint=\"b1j3\"/><child joint=\"b1j1\"/></link><start",
            1,
        );
    let error = read_kit_str("kit.xml", &ring).err().unwrap();
    says(&error, "2:3: the joints of b1 form a loop: each has a parent");
    // A link that only names itself.
    let error = broken(
        "<start",
        "<link name=\"x\" length=\"9\"><parent joint=\"b1j1\"/><child joint=\"b1j2\"/></link><start",
    );
    says(&error, "21:46: `x` names `b1j1` as its parent, but `b1j1` does not name `x` in return");
    let error =
        read_kit_str("kit.xml", "<data><beam name=\"b\"><joint name=\"j\" part=\"thru-m\"/></beam></data>");
    says(&error.err().unwrap(), "1:7: b has 1 joint, expected 2 to 32");
}

#[test]
fn problems_can_be_told_apart() {
    let error = broken("\"p2\"", "\"p1\"");
    assert_eq!(*error.problem(), KitProblem::DuplicateName { name: "p1".into() });
    assert_eq!(error.place().line_column(), (25, 14));
    assert_eq!(&error.place().file().text()[error.place().span()], "p1");
}

#[test]
fn prints_the_line() {
    let error = broken("\"20\"", "\"19\"");
    let mut out = String::new();
    miette::NarratableReportHandler::new().render_report(&mut out, &error).unwrap();
    assert!(out.contains("the tag 19 is used twice"), "{out}");
    assert!(out.contains("<peg name=\"p2\" marker=\"19\""), "{out}");
    assert!(out.contains("first used here"), "{out}");
}
