//! The ids and variables of a Fluent text, with their places: what the parser, which gives no
//! places, is asked for beside it.

use std::ops::Range;

/// The parser calls itself for each placeable, variant and argument within another; no wording needs
/// more than five, and a file with more than this many unclosed ones is broken anyway.
const DEEPEST: usize = 100;
/// A written number with more digits makes the plural rules panic.
const LONGEST_NUMBER: usize = 12;

/// What the parser, or what says its messages, must not be given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Harm {
    TooDeep,
    LongNumber,
}

/// A message as it is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message<'t> {
    pub id: &'t str,
    /// From its id to the next entry, in bytes.
    pub at: Range<usize>,
    /// What is filled in, with the byte of its `$`, in the order in which it is written.
    pub variables: Vec<(&'t str, usize)>,
}

/// The messages of a text in their order; terms, comments and what is none of them are passed over.
pub fn messages(text: &str) -> Vec<Message<'_>> {
    let mut found: Vec<Message> = Vec::new();
    // Whether the entry that is being read is a message, and what it is open within.
    let mut is_message = false;
    let mut depth = 0_usize;
    let mut quoted = false;
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let at_margin = !line.starts_with([' ', '\t', '\r', '\n']);
        let begins = depth == 0 && at_margin && !line.starts_with(['}', '[', '*']);
        if begins {
            end(&mut found, is_message, start);
            let id = name(line);
            is_message = line.starts_with(|c: char| c.is_ascii_alphabetic())
                && line[id.len()..].trim_start_matches(' ').starts_with('=');
            if is_message {
                found.push(Message {
                    id,
                    at: start..text.len(),
                    variables: Vec::new(),
                });
            }
        }
        if !line.starts_with('#') {
            for (i, c) in line.char_indices() {
                match c {
                    '"' if depth > 0 && !is_escaped(&line[..i]) => quoted = !quoted,
                    _ if quoted => {}
                    '{' => depth += 1,
                    '}' => depth = depth.saturating_sub(1),
                    '$' if depth > 0 && is_message => {
                        if let Some(message) = found.last_mut() {
                            message.variables.push((name(&line[i + 1..]), start + i));
                        }
                    }
                    _ => {}
                }
            }
            // A literal ends with its line.
            quoted = false;
        }
        start += line.len();
        // What is never closed spoils the messages behind it no further than to an empty line with
        // the margin after it.
        let next_at_margin =
            text[start..].starts_with(|c: char| c.is_ascii_alphabetic() || c == '#');
        if line.trim().is_empty() && next_at_margin {
            depth = 0;
        }
    }
    found
}

/// The first harm in a text, and its byte.
pub fn harm(text: &str) -> Option<(Harm, usize)> {
    let mut depth = 0_usize;
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        if !line.starts_with('#') {
            let mut digits = 0;
            for (i, c) in line.char_indices() {
                digits = if c.is_ascii_digit() { digits + 1 } else { 0 };
                match c {
                    '{' => depth += 1,
                    // Elsewhere it is text.
                    '(' if depth > 0 => depth += 1,
                    '}' | ')' => depth = depth.saturating_sub(1),
                    _ => {}
                }
                if depth > DEEPEST {
                    return Some((Harm::TooDeep, start + i));
                }
                if depth > 0 && digits > LONGEST_NUMBER {
                    return Some((Harm::LongNumber, start + i));
                }
            }
        }
        start += line.len();
    }
    None
}

fn end(found: &mut [Message], is_message: bool, byte: usize) {
    if let Some(message) = found.last_mut().filter(|_| is_message) {
        message.at.end = byte;
    }
}

/// The identifier at the start of `text`.
fn name(text: &str) -> &str {
    let end = text.find(|c: char| !c.is_ascii_alphanumeric() && c != '-' && c != '_');
    &text[..end.unwrap_or(text.len())]
}

fn is_escaped(before: &str) -> bool {
    let slashes = before.bytes().rev().take_while(|b| *b == b'\\').count();
    slashes % 2 == 1
}
