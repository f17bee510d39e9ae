//! Powers of the superuser that an agent must not have.

use rustix::thread::{CapabilitySet, CapabilitySets};

/// Those by which one process looks into another.
pub const TO_LOOK_INTO_OTHERS: CapabilitySet = CapabilitySet::SYS_PTRACE
    .union(CapabilitySet::SYS_ADMIN)
    .union(CapabilitySet::SYS_RAWIO)
    .union(CapabilitySet::SYS_MODULE)
    .union(CapabilitySet::PERFMON)
    .union(CapabilitySet::BPF)
    .union(CapabilitySet::CHECKPOINT_RESTORE);

/// No program that this process becomes has these powers. A process without powers has none to give up.
pub fn give_up(powers: CapabilitySet) {
    for power in powers.iter() {
        let _ = rustix::thread::remove_capability_from_bounding_set(power);
    }
}

/// This process and each program that it becomes have no powers.
pub fn give_up_all() {
    give_up(CapabilitySet::all());
    let none = CapabilitySet::empty();
    let none = CapabilitySets { effective: none, permitted: none, inheritable: none };
    let _ = rustix::thread::set_capabilities(None, none);
}
