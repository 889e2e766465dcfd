//! A soft sound for those who do not look: the countdown has begun. It is drawn by the program and played
//! by the player that the system has; where there is none, the countdown is only seen and read aloud.

use std::{
    f64::consts::TAU,
    io::{self, Write},
    process::{Command, Stdio},
    thread,
};

use bevy::prelude::*;
use tempfile::NamedTempFile;

use super::{attending::House, attract::Attract};
use crate::stage::say;

/// Players of Linux's sound servers and of the kernel's sound, and of macOS.
const PLAYERS: [&[&str]; 4] = [&["pw-play"], &["paplay"], &["aplay", "-q"], &["afplay"]];
/// Samples per second.
const RATE: u32 = 44_100;
/// Of each of two notes, in s; a fifth downwards: something ends. (A4 and D4, equal temperament.)
const NOTE_S: f64 = 0.9;
const NOTES_HZ: [f64; 2] = [440.0, 293.66];
/// A note has gone to 1/e after so many s, and begins without a click within so many.
const DECAY_S: f64 = 0.25;
const ATTACK_S: f64 = 0.02;
/// Of the loudest sample, of 1: quieter than somebody who speaks beside it.
const LOUDNESS: f64 = 0.25;

/// Rings.
#[derive(Resource)]
pub struct Chime(Box<dyn Fn() + Send + Sync>);

impl Chime {
    /// What rings is up to `ring`, which must not wait.
    pub fn new(ring: impl Fn() + Send + Sync + 'static) -> Self {
        Self(Box::new(ring))
    }

    /// Through the loudspeakers.
    pub fn aloud() -> Self {
        match sound() {
            Ok(file) => Self::new(move || play(&file)),
            Err(error) => {
                say(format_args!("recto: the countdown is silent: {error}"));
                Self::new(|| {})
            }
        }
    }
}

/// Rings when the countdown begins.
pub fn ring(
    attract: Res<Attract>,
    chime: Option<Res<Chime>>,
    house: Res<House>,
    mut was_counting: Local<bool>,
) {
    let counting = attract.countdown().is_some();
    if counting
        && !*was_counting
        && house.0.chime
        && let Some(chime) = chime
    {
        (chime.0)();
    }
    *was_counting = counting;
}

fn sound() -> io::Result<NamedTempFile> {
    let mut file = tempfile::Builder::new().suffix(".wav").tempfile()?;
    file.write_all(&wave())?;
    file.flush()?;
    Ok(file)
}

/// With the first player that there is, on a thread that waits for it.
fn play(file: &NamedTempFile) {
    let path = file.path().to_owned();
    let played = thread::Builder::new().name("chime".into()).spawn(move || {
        for player in PLAYERS {
            let [program, options @ ..] = player else {
                continue;
            };
            let mut command = Command::new(program);
            command
                .args(options)
                .arg(&path)
                .stdin(Stdio::null())
                .stdout(Stdio::null())
                .stderr(Stdio::null());
            // One that is there and plays nothing leaves it to the next.
            if command.status().is_ok_and(|status| status.success()) {
                return;
            }
        }
    });
    if let Err(error) = played {
        say(format_args!("recto: the countdown is silent: {error}"));
    }
}

/// The sound as a WAVE file: 16-bit PCM, one channel.
fn wave() -> Vec<u8> {
    let count = (NOTE_S * f64::from(RATE)) as u32;
    let samples = NOTES_HZ.iter().flat_map(|hz| {
        (0..count).map(move |k| {
            let t = f64::from(k) / f64::from(RATE);
            let swell = (t / ATTACK_S).min(1.0) * (-t / DECAY_S).exp();
            let tone = (TAU * hz * t).sin();
            (LOUDNESS * swell * tone * f64::from(i16::MAX)) as i16
        })
    });
    let bytes: Vec<u8> = samples.flat_map(i16::to_le_bytes).collect();
    let length = bytes.len() as u32;
    let mut wave = Vec::with_capacity(bytes.len() + 44);
    wave.extend(b"RIFF");
    wave.extend((length + 36).to_le_bytes());
    wave.extend(b"WAVEfmt ");
    wave.extend(16u32.to_le_bytes());
    // Linear, of one channel.
    wave.extend(1u16.to_le_bytes());
    wave.extend(1u16.to_le_bytes());
    wave.extend(RATE.to_le_bytes());
    wave.extend((2 * RATE).to_le_bytes());
    wave.extend(2u16.to_le_bytes());
    wave.extend(16u16.to_le_bytes());
    wave.extend(b"data");
    wave.extend(length.to_le_bytes());
    wave.extend(bytes);
    wave
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_soft_begins_and_ends_in_silence() {
        let wave = wave();
        let data = wave.windows(4).position(|four| four == b"data");
        let samples: Vec<i16> = wave[data.expect("samples") + 8..]
            .chunks_exact(2)
            .map(|two| i16::from_le_bytes([two[0], two[1]]))
            .collect();
        assert_eq!(wave.len(), 44 + 2 * samples.len());
        let loudest = samples.iter().map(|s| s.unsigned_abs()).max();
        let loudest = f64::from(loudest.unwrap_or(0)) / f64::from(i16::MAX);
        assert!(loudest > 0.1 && loudest <= LOUDNESS, "{loudest}");
        let note = samples.len() / NOTES_HZ.len();
        for note in samples.chunks(note) {
            let silence = |sample: &i16| sample.unsigned_abs() < 400;
            assert!(silence(&note[0]) && note.last().is_some_and(silence));
        }
    }
}
