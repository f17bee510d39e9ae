//! All parameters, and the file of their values.

use std::path::Path;
use std::sync::{Arc, LazyLock};

use ramp_kit::source::SourceFile;
use sha2::{Digest, Sha256};

use super::belief::{BeliefParameters, DiagnosisParameters, EyesParameters};
use super::contact::{
    ComplianceParameters, FeelParameters, PegSearchParameters, PressParameters, ProbeParameters,
    SearchParameters, TouchParameters,
};
use super::group::{Group, Values};
use super::hand::{
    CarryParameters, FeltParameters, GripParameters, HandParameters, ReleaseParameters, RiseParameters,
    TrimParameters,
};
use super::insertions::{AssembleParameters, CapParameters, InsertionParameters};
use super::motion::{AlignmentParameters, LookParameters, TravelParameters};
use super::read::{ParameterFault, read_values};
use super::skills::{
    AgentParameters, ClearParameters, FastenParameters, LayDownParameters, MoveToParameters,
    PickUpParameters, PieceParameters, PullOutParameters, PushParameters, PutDownParameters,
    RegraspParameters, RepairParameters, SheetPlaceParameters, SlideBackParameters, SlideParameters,
    TakeOutParameters,
};

/// The values of the baseline, `data/skills/baseline.toml`, as the program was built with.
pub const BASELINE: &str = include_str!("../../../../data/skills/baseline.toml");
/// Name of that file in messages.
const NAME: &str = "data/skills/baseline.toml";

macro_rules! groups {
    ($($(#[doc = $doc:literal])+ $table:ident: $group:ident,)+) => {
        /// The parameters of the baseline: one group for each table of the parameter file.
        #[derive(Clone, Debug, PartialEq)]
        pub struct Parameters {
            $($(#[doc = $doc])+ pub $table: $group,)+
            /// SHA-256, in hex, of the file that overrides the baseline's values, if there is one.
            pub sha256: Option<String>,
        }

        impl Parameters {
            fn from_values(values: &Values) -> Option<Parameters> {
                Some(Parameters {
                    $($table: $group::from_values(values, stringify!($table))?,)+
                    sha256: None,
                })
            }

            /// All groups, in the order of the data flow, from the agent down to the belief.
            pub fn groups(&self) -> Vec<Group> {
                vec![$(
                    Group {
                        table: stringify!($table),
                        about: $group::ABOUT,
                        fields: $group::FIELDS,
                        values: self.$table.values(),
                    },
                )+]
            }
        }

        /// The tables of the file and their fields.
        const TABLES: &[(&str, &[super::group::Field])] = &[$((stringify!($table), $group::FIELDS),)+];
    };
}

groups! {
    /// The agent.
    agent: AgentParameters,
    /// The agent before a build from a start whose parts lie anywhere.
    clear: ClearParameters,
    /// The places on the sheet to which parts are put back.
    sheet_place: SheetPlaceParameters,
    /// The agent before a build that begins with a frame.
    repair: RepairParameters,
    /// The agent on a piece of a plan.
    piece: PieceParameters,
    /// The skill `move_to`.
    move_to: MoveToParameters,
    /// The skill `pick_up`.
    pick_up: PickUpParameters,
    /// The skill `put_down`.
    put_down: PutDownParameters,
    /// Common parameters of `assemble`, `cap`, `lay_down` and `move_to`.
    insertion: InsertionParameters,
    /// The skill `assemble`.
    assemble: AssembleParameters,
    /// The skill `cap`.
    cap: CapParameters,
    /// The skill `lay_down`.
    lay_down: LayDownParameters,
    /// The skill `slide`.
    slide: SlideParameters,
    /// The skill `regrasp`.
    regrasp: RegraspParameters,
    /// The skill `push`.
    push: PushParameters,
    /// The skill `fasten`.
    fasten: FastenParameters,
    /// The skill `take_out`.
    take_out: TakeOutParameters,
    /// The skill `slide_back`.
    slide_back: SlideBackParameters,
    /// The skill `pull_out`.
    pull_out: PullOutParameters,
    /// Motions through free space.
    travel: TravelParameters,
    /// Looks.
    look: LookParameters,
    /// Grasps.
    grip: GripParameters,
    /// Carrying.
    carry: CarryParameters,
    /// Releasing.
    release: ReleaseParameters,
    /// First contact, and the search for the slots of a beam.
    feel: FeelParameters,
    /// Height measurement by contact.
    touch: TouchParameters,
    /// The compliant search.
    search: SearchParameters,
    /// Its motion through firmly held sleeves.
    search_sleeve: ComplianceParameters,
    /// Its motion through loosely held sleeves.
    search_loose: ComplianceParameters,
    /// Its motion with a cap.
    search_cap: ComplianceParameters,
    /// Probing for the mouth of a joint.
    probe: ProbeParameters,
    /// The search with a peg.
    peg_search: PegSearchParameters,
    /// Pressing a peg until it is seated.
    press: PressParameters,
    /// Alignment of the beams.
    alignment: AlignmentParameters,
    /// Diagnosis of faults.
    diagnosis: DiagnosisParameters,
    /// The hand.
    hand: HandParameters,
    /// The trim of a straight motion.
    trim: TrimParameters,
    /// The rise of a force over its running mean.
    rise: RiseParameters,
    /// The sense of touch.
    felt: FeltParameters,
    /// The belief.
    belief: BeliefParameters,
    /// The cameras.
    eyes: EyesParameters,
}

static DEFAULT: LazyLock<Arc<Parameters>> = LazyLock::new(|| {
    // The file is part of the program, and a test reads it.
    let read = || {
        let mut values = Values::new();
        read_values(&SourceFile::new(NAME, BASELINE), TABLES, &mut values)?;
        Ok(Parameters::from_values(&values))
    };
    let result: Result<Option<Parameters>, ParameterFault> = read();
    match result {
        Ok(Some(parameters)) => Arc::new(parameters),
        Ok(None) => panic!("{NAME} lacks a parameter"),
        Err(fault) => panic!("{fault:#}"),
    }
});

impl Parameters {
    /// The baseline's values.
    ///
    /// ```
    /// assert_eq!(ramp_skills::Parameters::baseline().travel.height, 0.15);
    /// ```
    pub fn baseline() -> Arc<Parameters> {
        DEFAULT.clone()
    }

    /// The baseline's values, except those that a file gives.
    ///
    /// # Errors
    /// A [`ParameterFault`] when the file cannot be read, is not TOML, has a table or a parameter that is not
    /// known, or a value of another form or out of range.
    pub fn read(path: &Path) -> Result<Arc<Parameters>, ParameterFault> {
        Parameters::from_source(&SourceFile::read(path)?)
    }

    /// As [`Parameters::read`], for a file that is already in memory.
    ///
    /// ```
    /// use ramp_kit::source::SourceFile;
    /// use ramp_skills::Parameters;
    ///
    /// let file = SourceFile::new("mine.toml", "[travel]\nheight = 0.2\n");
    /// assert_eq!(Parameters::from_source(&file).unwrap().travel.height, 0.2);
    /// let file = SourceFile::new("mine.toml", "[travel]\nhieght = 0.2\n");
    /// let fault = Parameters::from_source(&file).unwrap_err();
    /// assert_eq!(
    ///     format!("{fault:#}"),
    ///     "mine.toml:2:1: [travel] has no parameter `hieght` (did you mean `height`?)"
    /// );
    /// ```
    ///
    /// # Errors
    /// As [`Parameters::read`].
    pub fn from_source(file: &SourceFile) -> Result<Arc<Parameters>, ParameterFault> {
        let mut values = Values::new();
        for group in Parameters::baseline().groups() {
            for (field, numbers) in group.fields.iter().zip(group.values) {
                values.insert((group.table.to_string(), field.name.to_string()), numbers);
            }
        }
        read_values(file, TABLES, &mut values)?;
        let mut parameters =
            Parameters::from_values(&values).unwrap_or_else(|| Parameters::baseline().as_ref().clone());
        let hash = Sha256::digest(file.text().as_bytes());
        parameters.sha256 = Some(hash.iter().map(|byte| format!("{byte:02x}")).collect());
        Ok(Arc::new(parameters))
    }
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use super::*;

    fn fault(text: &str) -> String {
        let fault = Parameters::from_source(&SourceFile::new("mine.toml", text)).unwrap_err();
        format!("{fault:#}")
    }

    /// Every parameter has a value, a meaning, and a value within its limits.
    #[test]
    fn the_baseline_has_all_values() {
        let parameters = Parameters::baseline();
        assert_eq!(parameters.sha256, None);
        for group in parameters.groups() {
            assert_eq!(group.fields.len(), group.values.len());
            for (field, values) in group.fields.iter().zip(&group.values) {
                assert!(!field.meaning.trim().is_empty(), "{}.{}", group.table, field.name);
                assert!(values.iter().all(|value| (field.least..=field.most).contains(value)));
            }
        }
    }

    /// A file that gives nothing changes nothing but the hash; one that gives some values changes those.
    #[test]
    fn a_file_overrides_what_it_gives() {
        let empty = Parameters::from_source(&SourceFile::new("mine.toml", "")).unwrap();
        assert!(empty.sha256.is_some());
        let baseline = Parameters::baseline();
        assert_eq!(Parameters { sha256: None, ..empty.as_ref().clone() }, *baseline);
        let text = "[press]\ntries = 7\n[slide]\naside = [0, 1e-3, -1e-3, 2e-3, -2e-3]\n";
        let own = Parameters::from_source(&SourceFile::new("mine.toml", text)).unwrap();
        assert_eq!((own.press.tries, own.slide.aside[3]), (7, 2.0e-3));
        assert_eq!(own.press.force, baseline.press.force);
    }

    #[test]
    fn what_is_wrong_is_told_with_its_place() {
        for (text, told) in [
            ("[travel\n", "mine.toml:1:8: this is not valid TOML"),
            ("[travle]\n", "mine.toml:1:2: there is no table [travle] (did you mean `travel`?)"),
            ("speed = 1\n", "mine.toml:1:1: there is no table [speed]"),
            ("travel = 1\n", "mine.toml:1:10: found 1 for travel, expected a table"),
            (
                "[travel]\nheihgt = 1\n",
                "mine.toml:2:1: [travel] has no parameter `heihgt` (did you mean `height`?)",
            ),
            ("[travel]\nheight = \"a\"\n", "mine.toml:2:10: found height = \"a\", expected a number"),
            ("[travel]\nheight = nan\n", "mine.toml:2:10: found height = nan, expected a number from"),
            ("[travel]\nheight = -inf\n", "mine.toml:2:10: found height = -inf, expected a number from"),
            ("[travel]\nheight = 9e9\n", "mine.toml:2:10: found height = 9e9, expected a number from"),
            ("[press]\ntries = 1.5\n", "mine.toml:2:9: found tries = 1.5, expected a whole number from"),
            ("[press]\ntries = 0x10000000000000000000\n", "mine.toml:2:9: "),
            ("[slide]\naside = [1]\n", "mine.toml:2:9: found aside = [1], expected a list of 5 numbers"),
            (
                "[slide]\naside = [0, 0, 0, 0, true]\n",
                "mine.toml:2:9: found aside = [0, 0, 0, 0, true], expected",
            ),
            ("[travel]\nheight = 0.2\nheight = 0.3\n", "mine.toml:3:1: this is not valid TOML"),
        ] {
            let found = fault(text);
            assert!(found.starts_with(told), "{text:?}: {found}");
        }
    }
}
