//! Defects of a domain are reported at their place, with the most similar name.

use ramp_action_language::{Domain, SourceFile};

/// Declarations at the beginning of every case; they end on line 2.
const BEGIN: &str = "sort lamp = { red, green }. sort room. static in(lamp, room).\n\
     inertial fluent on(lamp). defined fluent dark(room). action press(lamp).\n";

fn message(laws: &str) -> String {
    let file = SourceFile::new("lamp.al", &format!("{BEGIN}{laws}"));
    format!("{:#}", Domain::new(&file, None).expect_err("the domain is wrong"))
}

#[test]
fn every_error_has_its_place_and_says_what_was_expected() {
    for (laws, expected) in [
        ("press(L) causes on(L)", "lamp.al:3:22: found the end of the file, expected `if`, `causes` or `.`"),
        (
            "press(L) cause on(L).",
            "lamp.al:3:10: found `cause`, expected `if`, `causes` or `.` (did you mean `causes`?)",
        ),
        ("pres(L) causes on(L).", "lamp.al:3:1: there is no action `pres` (did you mean `press`?)"),
        ("press(rad) causes on(red).", "lamp.al:3:7: `rad` is not of the sort `lamp` (did you mean `red`?)"),
        ("press(L, L) causes on(L).", "lamp.al:3:1: `press` has 2 arguments, but is declared with 1"),
        (
            "press(L) causes dark(R) if in(L, R).",
            "lamp.al:3:17: `dark` is a defined fluent, expected an inertial fluent",
        ),
        ("dark(R) if -dark(R).", "lamp.al:3:13: `dark` is defined by its own negation"),
        (
            "-dark(R).",
            "lamp.al:3:2: `dark` is a defined fluent and false unless derived, so a law cannot conclude `-dark`",
        ),
        (
            "press(_) causes on(_).",
            "lamp.al:3:20: `_` is not allowed in an effect (`_` means that some value will do, which only a condition can say)",
        ),
        (
            "dark(R) if in(L, R), on(R).",
            "lamp.al:3:25: the variable `R` would have to be of the sorts `room` and `lamp` at once",
        ),
        ("sort lamp.", "lamp.al:3:6: `lamp` is declared twice"),
        ("sort a = b. sort b = a.", "lamp.al:3:6: the sort `a` contains itself"),
        ("on(red) if ?.", "lamp.al:3:12: unexpected character `?`"),
        ("on(\"r\u{1b}d\").", "lamp.al:3:6: unexpected character `\\u{1b}`"),
        ("on(red) if in(red, \"hall).", "lamp.al:3:20: this name has no closing quote on its line"),
    ] {
        assert_eq!(message(laws), expected, "{laws}");
    }
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let error = Domain::read("no/such/file.al".as_ref(), None).expect_err("there is no such file");
    assert_eq!(format!("{error:#}"), "cannot read no/such/file.al: there is no such file");
}
