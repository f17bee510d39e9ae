//! The filter of system calls, made from the list in `calls`.
//!
//! Two filters stand on one another, and the kernel takes the stricter answer; of two errors, that of the
//! newer filter. The older one refuses (`EPERM`) each call that is not allowed. The newer one says `ENOSYS`
//! to each call that this program does not know. x86-64 has a second form of each call (x32) with numbers of
//! its own, which are unknown here.

use std::collections::BTreeMap;

use seccompiler::{
    BpfProgram, SeccompAction, SeccompCmpArgLen, SeccompCmpOp, SeccompCondition, SeccompFilter, SeccompRule,
    TargetArch,
};

use super::calls::{DENIED_AS_UNKNOWN, Processor, Test, Treatment, limited, treatment};

/// Why the filter cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum FilterError {
    /// No list for this processor.
    #[error("there is no list of system calls for {0}")]
    Processor(&'static str),
    /// The filter does not compile, or the kernel does not take it.
    #[error(transparent)]
    Filter(#[from] seccompiler::Error),
    /// A rule is wrong.
    #[error(transparent)]
    Rule(#[from] seccompiler::BackendError),
}

type Rules = BTreeMap<i64, Vec<SeccompRule>>;

/// From now on, this process and all that it starts can make only the listed calls.
///
/// # Errors
/// When the kernel has no filters, or this is another processor than x86-64, aarch64 or riscv64.
pub fn apply(graphics: bool) -> Result<(), FilterError> {
    let name = std::env::consts::ARCH;
    let processor = Processor::named(name).ok_or(FilterError::Processor(name))?;
    for program in programs(processor, graphics)? {
        seccompiler::apply_filter(&program)?;
    }
    Ok(())
}

/// The two filters for a processor, in the order in which they are put on.
///
/// # Errors
/// When one does not compile.
pub fn programs(processor: Processor, graphics: bool) -> Result<[BpfProgram; 2], FilterError> {
    let mut allowed = Rules::new();
    let mut known = Rules::new();
    for (number, name) in processor.calls() {
        let rules = match treatment(name, graphics) {
            // The filters are put on with it; the newer one then denies it.
            Treatment::Unknown if name == "seccomp" => Some(Vec::new()),
            Treatment::Allowed => Some(Vec::new()),
            Treatment::Limited => Some(rules_of(name, graphics)?),
            Treatment::Refused | Treatment::Unknown => None,
        };
        if let Some(rules) = rules {
            allowed.insert(number.into(), rules);
        }
        if !DENIED_AS_UNKNOWN.iter().any(|(unknown, _)| *unknown == name) {
            known.insert(number.into(), Vec::new());
        }
    }
    Ok([program(allowed, libc::EPERM, processor)?, program(known, libc::ENOSYS, processor)?])
}

/// Allows what has a rule that holds; all else fails with an error.
fn program(rules: Rules, error: i32, processor: Processor) -> Result<BpfProgram, FilterError> {
    let arch = TargetArch::try_from(processor.name())?;
    let refused = SeccompAction::Errno(error.unsigned_abs());
    Ok(BpfProgram::try_from(SeccompFilter::new(rules, refused, SeccompAction::Allow, arch)?)?)
}

/// The rules of a call with conditions; none where one alternative holds always.
fn rules_of(call: &str, graphics: bool) -> Result<Vec<SeccompRule>, FilterError> {
    let alternatives = limited(graphics).filter(|it| it.call == call).flat_map(|it| it.alternatives);
    let mut rules = Vec::new();
    for tests in alternatives {
        if tests.is_empty() {
            return Ok(Vec::new());
        }
        let conditions = tests.iter().map(condition).collect::<Result<Vec<_>, _>>()?;
        rules.push(SeccompRule::new(conditions)?);
    }
    Ok(rules)
}

fn condition(test: &Test) -> Result<SeccompCondition, seccompiler::BackendError> {
    let compare = SeccompCmpOp::MaskedEq(test.mask.into());
    SeccompCondition::new(test.argument, SeccompCmpArgLen::Dword, compare, test.value.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_processor_has_filters_that_compile() {
        for processor in Processor::ALL {
            for graphics in [false, true] {
                for program in programs(processor, graphics).expect("compiles") {
                    // The kernel's limit.
                    assert!(program.len() <= 4096, "{}: {} instructions", processor.name(), program.len());
                }
            }
        }
    }
}
