//! Signals to the supervisor, and from it to the window.

use std::{
    fmt, io,
    process::Child,
    sync::mpsc::{self, Receiver},
};

/// What asks a program to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    Terminate,
    Interrupt,
    HangUp,
}

impl fmt::Display for Signal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Terminate => "SIGTERM",
            Self::Interrupt => "SIGINT",
            Self::HangUp => "SIGHUP",
        })
    }
}

/// Takes the signals that ask this program to end: they no longer end it, and come out here.
/// Children are not kept from theirs: the standard library unblocks what it starts.
///
/// # Errors
/// If the system refuses.
#[cfg(unix)]
pub fn taken() -> io::Result<Receiver<Signal>> {
    use nix::sys::signal::{SigSet, Signal as Unix};

    let mut set = SigSet::empty();
    for signal in [Unix::SIGTERM, Unix::SIGINT, Unix::SIGHUP] {
        set.add(signal);
    }
    set.thread_block()?;
    let (sender, receiver) = mpsc::channel();
    let wait = move || {
        while let Ok(signal) = set.wait() {
            let signal = match signal {
                Unix::SIGINT => Signal::Interrupt,
                Unix::SIGHUP => Signal::HangUp,
                _ => Signal::Terminate,
            };
            if sender.send(signal).is_err() {
                break;
            }
        }
    };
    std::thread::Builder::new()
        .name("signals".into())
        .spawn(wait)?;
    Ok(receiver)
}

/// Elsewhere the system ends this program, and the window by itself.
///
/// # Errors
/// None.
#[cfg(not(unix))]
pub fn taken() -> io::Result<Receiver<Signal>> {
    Ok(mpsc::channel().1)
}

/// Asks the child to end; one that has ended already is past asking.
#[cfg(unix)]
pub fn pass_on(child: &mut Child, signal: Signal) {
    use nix::{
        sys::signal::{Signal as Unix, kill},
        unistd::Pid,
    };

    // Its number is its own until it was waited for.
    if !matches!(child.try_wait(), Ok(None)) {
        return;
    }
    let signal = match signal {
        Signal::Terminate => Unix::SIGTERM,
        Signal::Interrupt => Unix::SIGINT,
        Signal::HangUp => Unix::SIGHUP,
    };
    if let Ok(id) = i32::try_from(child.id()) {
        let _ = kill(Pid::from_raw(id), signal);
    }
}

/// Elsewhere a program is ended without being asked.
#[cfg(not(unix))]
pub fn pass_on(child: &mut Child, _: Signal) {
    let _ = child.kill();
}
