//! Light directions as programs for RTI and PTM write them (`.lp`): the number of lamps, and then
//! a line for each with a file name and the direction x, y and z, y up.

use std::path::{Path, PathBuf};

use glam::DVec3;

/// How far from 1 a direction's length may be: some programs write three digits.
const LENGTH: f64 = 0.05;
/// How many faults are listed.
const MOST_FAULTS: usize = 20;

/// One lamp of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct LpLamp {
    /// As written, often with a folder of another machine.
    pub file: String,
    /// Unit vector towards the lamp.
    pub direction: DVec3,
}

impl LpLamp {
    /// Where its photograph is beside a `.lp` file in `folder`: as written, or without the folders
    /// of the machine that wrote it.
    pub fn beside(&self, folder: &Path) -> PathBuf {
        let name = self.file.replace('\\', "/");
        let written = folder.join(&name);
        if written.is_file() {
            return written;
        }
        let bare = folder.join(name.rsplit('/').next().unwrap_or(&name));
        if bare.is_file() { bare } else { written }
    }
}

/// What is wrong with a line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: found {found}; {remedy}")]
pub struct LpFault {
    /// From 1.
    pub line: usize,
    pub found: String,
    pub remedy: &'static str,
}

/// Reads the text of a `.lp` file. Directions are made unit vectors.
///
/// # Errors
/// All faults, up to twenty.
pub fn read(text: &str) -> Result<Vec<LpLamp>, Vec<LpFault>> {
    let mut faults = Vec::new();
    let fault = |line, found: String, remedy| LpFault {
        line,
        found,
        remedy,
    };
    let mut lines = text
        .trim_start_matches('\u{feff}')
        .lines()
        .enumerate()
        .map(|(i, line)| (i + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let count = match lines.next() {
        Some((line, first)) => match first.parse::<usize>() {
            Ok(count) => count,
            Err(_) => {
                let found = format!("{:?}", shortened(first));
                return Err(vec![fault(line, found, "write the number of lamps first")]);
            }
        },
        None => {
            let remedy = "write the number of lamps, and a line for each";
            return Err(vec![fault(1, "nothing".to_owned(), remedy)]);
        }
    };
    let mut lamps = Vec::new();
    let mut last = 1;
    for (line, row) in lines {
        last = line;
        if faults.len() >= MOST_FAULTS {
            break;
        }
        match lamp(row) {
            Ok(lamp) => lamps.push(lamp),
            Err(remedy) => faults.push(fault(line, format!("{:?}", shortened(row)), remedy)),
        }
    }
    if faults.is_empty() && lamps.len() != count {
        let found = format!("{} lamps where the first line says {count}", lamps.len());
        faults.push(fault(
            last,
            found,
            "correct the number, or add what is missing",
        ));
    }
    if faults.is_empty() {
        Ok(lamps)
    } else {
        Err(faults)
    }
}

/// The lamp of a row; file names may hold spaces.
fn lamp(row: &str) -> Result<LpLamp, &'static str> {
    const SHAPE: &str = "write a file name and three numbers";
    let mut rest = row;
    let mut numbers = [0.0; 3];
    for number in numbers.iter_mut().rev() {
        let (before, last) = rest.rsplit_once(|c: char| c.is_whitespace()).ok_or(SHAPE)?;
        let value: f64 = last.parse().map_err(|_| SHAPE)?;
        if !value.is_finite() {
            return Err("write ordinary numbers");
        }
        *number = value;
        rest = before.trim_end();
    }
    let direction = DVec3::from(numbers);
    if (direction.length() - 1.0).abs() > LENGTH {
        return Err(
            "write a direction, whose squares sum to 1; places in mm go into position_mm of a capture file",
        );
    }
    if direction.z <= 0.0 {
        return Err("the lamp would be behind the sheet: the third number is above 0");
    }
    if rest.is_empty() {
        return Err(SHAPE);
    }
    Ok(LpLamp {
        file: rest.to_owned(),
        direction: direction.normalize(),
    })
}

fn shortened(text: &str) -> String {
    text.chars().take(60).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_faults_of_a_file_are_found_at_once() {
        let text = "4\na b.jpg 0 0 1\nb.jpg 0 0 2\nc.jpg 0 1\nd.jpg 0 0 -1\n";
        let faults = read(text).expect_err("faults");
        let lines: Vec<_> = faults.iter().map(|fault| fault.line).collect();
        assert_eq!(lines, [3, 4, 5]);
        let lamps = read("1\r\na b.jpg 0.6 0 0.8\r\n").expect("a lamp");
        assert_eq!(lamps[0].file, "a b.jpg");
        assert_eq!(lamps[0].direction, DVec3::new(0.6, 0.0, 0.8));
        assert_eq!(read("2\na.jpg 0 0 1").expect_err("too few")[0].line, 2);
        assert_eq!(read("").expect_err("nothing")[0].line, 1);
        assert_eq!(read("x").expect_err("no number")[0].line, 1);
        let lamps = read("# a dome\n1\na.jpg 0 0 1\n# its end\n").expect("a lamp");
        assert_eq!(lamps.len(), 1);
    }
}
