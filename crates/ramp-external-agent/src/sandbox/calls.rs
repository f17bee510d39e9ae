//! The system calls that an agent in a sandbox may make: a list by name, for x86-64, aarch64 and riscv64.
//!
//! Every call outside this list fails. A call that this program knows fails with `EPERM`. A call that it does
//! not know, and those in [`DENIED_AS_UNKNOWN`], fail with `ENOSYS`, so that a C library uses an older call.

use syscalls::{aarch64, riscv64, x86_64};

/// Calls that are allowed with every argument, for one reason.
#[derive(Clone, Copy, Debug)]
pub struct Group {
    /// Why an agent may make these calls.
    pub reason: &'static str,
    /// Their names. A processor that lacks one ignores it.
    pub calls: &'static [&'static str],
}

/// A comparison of the lower 32 bits of an argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Test {
    /// Index of the argument, from 0.
    pub argument: u8,
    /// Bits that count.
    pub mask: u32,
    /// Their required value.
    pub value: u32,
}

/// A call that is allowed with some arguments only. With others it fails with `EPERM`.
#[derive(Clone, Copy, Debug)]
pub struct Limited {
    /// Its name.
    pub call: &'static str,
    /// The allowed arguments, for a person.
    pub allowed: &'static str,
    /// Why all other arguments are refused.
    pub reason: &'static str,
    /// Alternatives; all tests of one must hold.
    pub alternatives: &'static [&'static [Test]],
}

/// The treatment of a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Treatment {
    /// Allowed.
    Allowed,
    /// Allowed with some arguments.
    Limited,
    /// It fails with `EPERM`.
    Refused,
    /// It fails with `ENOSYS`.
    Unknown,
}

const fn is(argument: u8, value: u32) -> Test {
    Test { argument, mask: u32::MAX, value }
}

const fn masked(argument: u8, mask: u32, value: u32) -> Test {
    Test { argument, mask, value }
}

/// Calls that are allowed with every argument.
pub const ALLOWED: &[Group] = &[
    Group {
        reason: "reading and writing what is open",
        calls: &[
            "read",
            "write",
            "pread64",
            "pwrite64",
            "readv",
            "writev",
            "preadv",
            "pwritev",
            "preadv2",
            "pwritev2",
            "lseek",
            "close",
            "close_range",
            "dup",
            "dup2",
            "dup3",
            "pipe",
            "pipe2",
            "sendfile",
            "splice",
            "tee",
            "vmsplice",
            "copy_file_range",
            "ftruncate",
            "fallocate",
            "fsync",
            "fdatasync",
            "sync_file_range",
            "fadvise64",
            "readahead",
            "flock",
        ],
    },
    Group {
        reason: "files by their path: Landlock and the mounts decide which",
        calls: &[
            "open",
            "openat",
            "openat2",
            "creat",
            "getdents",
            "getdents64",
            "mkdir",
            "mkdirat",
            "rmdir",
            "unlink",
            "unlinkat",
            "rename",
            "renameat",
            "renameat2",
            "link",
            "linkat",
            "symlink",
            "symlinkat",
            "readlink",
            "readlinkat",
            "getcwd",
            "chdir",
            "fchdir",
            "umask",
        ],
    },
    Group {
        reason: "facts about files, which are not changed",
        calls: &[
            "stat",
            "lstat",
            "fstat",
            "newfstatat",
            "fstatat",
            "statx",
            "access",
            "faccessat",
            "faccessat2",
            "statfs",
            "fstatfs",
            "getxattr",
            "lgetxattr",
            "fgetxattr",
            "listxattr",
            "llistxattr",
            "flistxattr",
        ],
    },
    Group {
        reason: "its own memory",
        calls: &[
            "brk",
            "munmap",
            "mremap",
            "mprotect",
            "msync",
            "madvise",
            "mlock",
            "mlock2",
            "munlock",
            "mlockall",
            "munlockall",
            "mseal",
            "pkey_alloc",
            "pkey_free",
            "pkey_mprotect",
            "mbind",
            "get_mempolicy",
            "set_mempolicy",
            "membarrier",
            "arch_prctl",
            "riscv_flush_icache",
            "riscv_hwprobe",
        ],
    },
    Group {
        reason: "processes and threads of its own; their number is limited",
        calls: &[
            "fork",
            "vfork",
            "execve",
            "execveat",
            "exit",
            "exit_group",
            "wait4",
            "waitid",
            "set_tid_address",
            "set_robust_list",
            "rseq",
            "futex",
            "futex_waitv",
            "futex_wake",
            "futex_wait",
            "futex_requeue",
            "setsid",
            "setpgid",
            "sched_yield",
            "getcpu",
            "restart_syscall",
        ],
    },
    Group {
        reason: "its own numbers and those of its processes",
        calls: &[
            "getpid",
            "getppid",
            "gettid",
            "getpgrp",
            "getpgid",
            "getsid",
            "getuid",
            "geteuid",
            "getgid",
            "getegid",
            "getresuid",
            "getresgid",
            "getgroups",
            "uname",
            "sysinfo",
            "times",
            "getrusage",
            "getrlimit",
            "setrlimit",
        ],
    },
    Group {
        reason: "how many processors it may use: mathematics libraries and threads ask for it by number",
        calls: &["sched_getaffinity", "sched_get_priority_max", "sched_get_priority_min"],
    },
    Group {
        reason: "signals: Landlock and the name space confine them to its own processes",
        calls: &[
            "kill",
            "tkill",
            "tgkill",
            "rt_sigaction",
            "rt_sigprocmask",
            "rt_sigreturn",
            "rt_sigpending",
            "rt_sigtimedwait",
            "rt_sigsuspend",
            "sigaltstack",
            "signalfd",
            "signalfd4",
            "pause",
        ],
    },
    Group {
        reason: "clocks and timers",
        calls: &[
            "time",
            "gettimeofday",
            "clock_gettime",
            "clock_getres",
            "clock_nanosleep",
            "nanosleep",
            "getitimer",
            "setitimer",
            "alarm",
            "timer_create",
            "timer_settime",
            "timer_gettime",
            "timer_getoverrun",
            "timer_delete",
            "timerfd_create",
            "timerfd_settime",
            "timerfd_gettime",
        ],
    },
    Group {
        reason: "waiting for several things at once",
        calls: &[
            "select",
            "pselect6",
            "poll",
            "ppoll",
            "epoll_create",
            "epoll_create1",
            "epoll_ctl",
            "epoll_wait",
            "epoll_pwait",
            "epoll_pwait2",
            "eventfd",
            "eventfd2",
        ],
    },
    Group {
        reason: "a pair of sockets between its own processes",
        calls: &[
            "sendto",
            "recvfrom",
            "sendmsg",
            "recvmsg",
            "sendmmsg",
            "recvmmsg",
            "shutdown",
            "getsockname",
            "getpeername",
            "getsockopt",
            "setsockopt",
        ],
    },
    Group { reason: "random numbers", calls: &["getrandom"] },
];

/// Flags of `clone` that make name spaces.
const NAME_SPACES: u32 = 0x7e02_0000;
/// Bits of `mmap`'s flags: shared, of no file, and in huge pages.
const SHARED_OF_NO_FILE: u32 = 0x21;
const HUGE: u32 = 0x4_0000;

/// Calls that are allowed with some arguments.
pub const LIMITED: &[Limited] = &[
    Limited {
        call: "clone",
        allowed: "without flags for name spaces",
        reason: "a name space of its own gives back the powers that it has lost",
        alternatives: &[&[masked(0, NAME_SPACES, 0)]],
    },
    Limited {
        call: "mmap",
        allowed: "not shared without a file, not in huge pages",
        reason: "no limit counts such memory",
        alternatives: &[
            &[masked(3, SHARED_OF_NO_FILE | HUGE, 0x00)],
            &[masked(3, SHARED_OF_NO_FILE | HUGE, 0x01)],
            &[masked(3, SHARED_OF_NO_FILE | HUGE, 0x20)],
        ],
    },
    Limited {
        call: "ioctl",
        allowed: "`TCGETS`, `TCGETS2`, `TIOCGWINSZ`, `FIONREAD`, `FIONBIO`, `FIOCLEX`, `FIONCLEX`",
        reason: "others change attributes of files, or act on terminals and devices",
        alternatives: &[
            &[is(1, 0x5401)],
            &[is(1, 0x802c_542a)],
            &[is(1, 0x5413)],
            &[is(1, 0x541b)],
            &[is(1, 0x5421)],
            &[is(1, 0x5451)],
            &[is(1, 0x5450)],
        ],
    },
    Limited {
        call: "fcntl",
        allowed: "copies, flags, locks, and the size of a pipe",
        reason: "others send signals, watch folders, or leave marks on a file",
        alternatives: &[
            &[is(1, 0)],
            &[is(1, 1)],
            &[is(1, 2)],
            &[is(1, 3)],
            &[is(1, 4)],
            &[is(1, 5)],
            &[is(1, 6)],
            &[is(1, 7)],
            &[is(1, 36)],
            &[is(1, 37)],
            &[is(1, 38)],
            &[is(1, 1030)],
            &[is(1, 1032)],
        ],
    },
    Limited {
        call: "prctl",
        allowed: "names of threads and memory, the signal at its parent's end, timer slack, huge pages, \
                  questions",
        reason: "others change what the run sees of it",
        alternatives: &[
            &[is(0, 1)],
            &[is(0, 2)],
            &[is(0, 3)],
            &[is(0, 15)],
            &[is(0, 16)],
            &[is(0, 21)],
            &[is(0, 23)],
            &[is(0, 29)],
            &[is(0, 30)],
            &[is(0, 38)],
            &[is(0, 39)],
            &[is(0, 41)],
            &[is(0, 42)],
            &[is(0, 0x5356_4d41)],
        ],
    },
    Limited {
        call: "prlimit64",
        allowed: "itself (process 0)",
        reason: "limits of another process end it",
        alternatives: &[&[is(0, 0)]],
    },
    Limited {
        call: "sched_setaffinity",
        allowed: "itself (thread 0)",
        reason: "another process would be moved to other processors",
        alternatives: &[&[is(0, 0)]],
    },
    Limited {
        call: "sched_getscheduler",
        allowed: "itself (thread 0)",
        reason: "the numbers of other processes would be found",
        alternatives: &[&[is(0, 0)]],
    },
    Limited {
        call: "sched_getparam",
        allowed: "itself (thread 0)",
        reason: "the numbers of other processes would be found",
        alternatives: &[&[is(0, 0)]],
    },
    Limited {
        call: "getpriority",
        allowed: "itself (process 0)",
        reason: "the numbers of other processes would be found",
        alternatives: &[&[is(0, 0), is(1, 0)]],
    },
    Limited {
        call: "setpriority",
        allowed: "itself (process 0)",
        reason: "other processes would become slower",
        alternatives: &[&[is(0, 0), is(1, 0)]],
    },
    Limited {
        call: "socketpair",
        allowed: "`AF_UNIX`, of the types `SOCK_STREAM` and `SOCK_SEQPACKET`",
        reason: "a socket for datagrams can send to any other socket of the system",
        alternatives: &[&[is(0, 1), masked(1, 0xf, 1)], &[is(0, 1), masked(1, 0xf, 5)]],
    },
    Limited {
        call: "mknod",
        allowed: "a pipe with a name",
        reason: "devices and sockets are not files",
        alternatives: &[&[masked(1, 0xf000, 0x1000)]],
    },
    Limited {
        call: "mknodat",
        allowed: "a pipe with a name",
        reason: "devices and sockets are not files",
        alternatives: &[&[masked(2, 0xf000, 0x1000)]],
    },
];

/// Calls that are allowed beside [`LIMITED`] on a system with a graphics card: its drivers need them.
pub const WITH_GRAPHICS: &[Limited] = &[
    Limited {
        call: "ioctl",
        allowed: "requests of the drivers of NVIDIA, AMD and the Direct Rendering Manager",
        reason: "Landlock confines them to the graphics devices (Linux 6.10)",
        alternatives: &[
            &[masked(1, 0xff00, 0x4600)],
            &[masked(1, 0xff00, 0x4b00)],
            &[masked(1, 0xff00, 0x6400)],
            &[masked(1, 0xffff_ff00, 0)],
            &[masked(1, 0xffff_fffc, 0x3000_0000)],
        ],
    },
    Limited {
        call: "mmap",
        allowed: "shared without a file",
        reason: "memory that the card reads as well; only its pages in use are counted",
        alternatives: &[&[masked(3, SHARED_OF_NO_FILE | HUGE, 0x21)]],
    },
    Limited {
        call: "memfd_create",
        allowed: "every argument",
        reason: "memory that drivers exchange; it is counted while it is open",
        alternatives: &[&[]],
    },
];

/// Calls that this program knows and that fail like unknown ones (`ENOSYS`), and why.
pub const DENIED_AS_UNKNOWN: &[(&str, &str)] = &[
    ("clone3", "its flags lie behind a pointer, where no filter sees them; C libraries then use `clone`"),
    ("seccomp", "the sandbox makes its own filter with it, and is the last to do so"),
];

/// Calls that the kernel shows to no filter. They act in code that the kernel itself has placed into a
/// program that is traced; elsewhere they fail or end the process.
pub const UNFILTERED: &[&str] = &["uprobe", "uretprobe"];

/// A processor whose calls have numbers here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Processor {
    /// `x86_64`.
    X86,
    /// `aarch64`.
    Arm,
    /// `riscv64`.
    RiscV,
}

impl Processor {
    /// All of them.
    pub const ALL: [Processor; 3] = [Processor::X86, Processor::Arm, Processor::RiscV];

    /// The one with a name of Rust's (`std::env::consts::ARCH`).
    pub fn named(name: &str) -> Option<Processor> {
        Processor::ALL.into_iter().find(|it| it.name() == name)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Processor::X86 => "x86_64",
            Processor::Arm => "aarch64",
            Processor::RiscV => "riscv64",
        }
    }

    /// The calls that this program knows: numbers and names, in order of the numbers.
    pub fn calls(self) -> Vec<(i32, &'static str)> {
        match self {
            Processor::X86 => x86_64::Sysno::iter().map(|it| (it.id(), it.name())).collect(),
            Processor::Arm => aarch64::Sysno::iter().map(|it| (it.id(), it.name())).collect(),
            Processor::RiscV => riscv64::Sysno::iter().map(|it| (it.id(), it.name())).collect(),
        }
    }
}

/// The treatment of a call by its name, with or without a graphics card.
pub fn treatment(call: &str, graphics: bool) -> Treatment {
    if DENIED_AS_UNKNOWN.iter().any(|(name, _)| *name == call) {
        Treatment::Unknown
    } else if ALLOWED.iter().any(|group| group.calls.contains(&call)) {
        Treatment::Allowed
    } else if limited(graphics).any(|it| it.call == call) {
        Treatment::Limited
    } else {
        Treatment::Refused
    }
}

/// The calls with conditions.
pub fn limited(graphics: bool) -> impl Iterator<Item = &'static Limited> {
    LIMITED.iter().chain(WITH_GRAPHICS.iter().filter(move |_| graphics))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A misspelt name would be refused without a word.
    #[test]
    fn every_name_is_a_call_of_some_processor_and_is_listed_once() {
        let known: Vec<&str> =
            Processor::ALL.iter().flat_map(|it| it.calls()).map(|(_, name)| name).collect();
        let allowed = ALLOWED.iter().flat_map(|group| group.calls).copied();
        let names: Vec<&str> = allowed
            .chain(LIMITED.iter().map(|it| it.call))
            .chain(DENIED_AS_UNKNOWN.iter().map(|(name, _)| *name))
            .collect();
        for (index, name) in names.iter().enumerate() {
            assert!(known.contains(name), "{name} is no system call");
            assert!(!names[..index].contains(name), "{name} is listed twice");
        }
    }

    /// A program needs some calls to start, and may make none of some others, on every processor.
    #[test]
    fn every_processor_has_the_calls_that_a_program_needs() {
        for processor in Processor::ALL {
            let calls = processor.calls();
            let at = |name: &str| calls.iter().find(|it| it.1 == name).map(|it| treatment(it.1, false));
            for name in ["execve", "mmap", "openat", "read", "exit_group", "futex", "clone", "statx"] {
                assert!(
                    matches!(at(name), Some(Treatment::Allowed | Treatment::Limited)),
                    "{name} on {}",
                    processor.name()
                );
            }
            for name in ["ptrace", "socket", "fsetxattr", "fchmod", "fchmodat2", "setxattrat", "unshare"] {
                assert_eq!(at(name), Some(Treatment::Refused), "{name} on {}", processor.name());
            }
        }
    }
}
