//! Kit files.
#![no_main]

use ramp_fuzz::{data, points, target};
use ramp_kit::{kit_xml, read_kit_str};

fn check(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    match read_kit_str("kit.xml", &text) {
        Ok(kit) => {
            let xml = kit_xml(&kit, "Again.");
            match read_kit_str("again.xml", &xml) {
                Ok(again) => assert_eq!(again.beams, kit.beams),
                Err(error) => panic!("{error:#}\n{xml}"),
            }
        }
        Err(error) => points(&error, &text),
    }
}

target!([data("kit.xml")], check);
