//! A reader of pages and drawings, strict enough to find what a browser would guess at.

use std::collections::BTreeSet;

/// An element, in the order of their beginnings.
#[derive(Debug, Default)]
pub struct Element {
    pub name: String,
    pub attributes: Vec<(String, String)>,
    /// What stands in it directly.
    pub text: String,
    pub parent: Option<usize>,
}

impl Element {
    pub fn get(&self, name: &str) -> &str {
        let found = self.attributes.iter().find(|(of, _)| of == name);
        found.map_or("", |(_, value)| value)
    }

    pub fn number(&self, name: &str) -> f64 {
        let value = self.get(name);
        let number = value.parse();
        number.unwrap_or_else(|_| panic!("{name}=\"{value}\" of {self:?}"))
    }
}

/// What a page may have, and how it ends.
const VOID: [&str; 3] = ["meta", "img", "br"];
/// Elements that end with what holds them, or with the next of their kind.
const LOOSE: [&str; 6] = ["html", "p", "li", "tr", "td", "th"];
const FIRM: [&str; 26] = [
    "title",
    "style",
    "h1",
    "h2",
    "h3",
    "table",
    "figure",
    "figcaption",
    "ul",
    "strong",
    "details",
    "summary",
    "span",
    "svg",
    "text",
    "line",
    "circle",
    "rect",
    "path",
    "g",
    "em",
    "i",
    "b",
    "ol",
    "section",
    "code",
];
/// What ends a paragraph that is open.
const BLOCKS: [&str; 10] = [
    "p", "h1", "h2", "h3", "table", "figure", "ul", "ol", "details", "section",
];

/// Whether every `&` begins a character's name.
fn escaped(text: &str) -> bool {
    text.split('&').skip(1).all(|rest| {
        ["amp;", "lt;", "gt;", "quot;"]
            .iter()
            .any(|name| rest.starts_with(name))
    })
}

fn attributes(mut text: &str) -> Result<Vec<(String, String)>, String> {
    let mut found: Vec<(String, String)> = Vec::new();
    loop {
        text = text.trim_start();
        if text.is_empty() {
            return Ok(found);
        }
        let (name, rest) = text.split_once('=').ok_or(format!("no value: {text}"))?;
        let sound =
            !name.is_empty() && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-');
        // `colspan=2` is allowed in HTML.
        let (value, rest) = match rest.strip_prefix('"') {
            Some(rest) => rest.split_once('"').ok_or(format!("no end: {rest}"))?,
            None => rest.split_at(rest.find(' ').unwrap_or(rest.len())),
        };
        if !sound || !escaped(value) || value.contains('<') {
            return Err(format!("{name}=\"{value}\""));
        }
        if found.iter().any(|(of, _)| of == name) {
            return Err(format!("{name} twice"));
        }
        found.push((name.to_owned(), value.to_owned()));
        text = rest;
    }
}

/// Reads a page, or a part of one.
pub fn read(page: &str) -> Result<Vec<Element>, String> {
    let page = page.strip_prefix("<!doctype html>").unwrap_or(page);
    let mut all: Vec<Element> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    let mut rest = page;
    while let Some(at) = rest.find('<') {
        let words = &rest[..at];
        if !escaped(words) || words.contains('>') {
            return Err(format!("text: {words}"));
        }
        if let Some(i) = open.last() {
            all[*i].text += words;
        }
        let (tag, after) = rest[at + 1..]
            .split_once('>')
            .ok_or(format!("no end: {}", &rest[at..]))?;
        rest = after;
        if let Some(name) = tag.strip_prefix('/') {
            loop {
                let last = open.pop().ok_or(format!("</{name}> of nothing"))?;
                if all[last].name == name {
                    break;
                }
                if !LOOSE.contains(&all[last].name.as_str()) {
                    return Err(format!("</{name}> within {}", all[last].name));
                }
            }
            continue;
        }
        let (tag, closed) = match tag.strip_suffix('/') {
            Some(tag) => (tag, true),
            None => (tag, false),
        };
        let (name, inner) = tag.split_once(' ').unwrap_or((tag, ""));
        if ![&VOID[..], &LOOSE, &FIRM].concat().contains(&name) {
            return Err(format!("<{name}>"));
        }
        // What a loose element ends.
        let ends = |of: &str| match name {
            "td" | "th" => of == "td" || of == "th",
            "tr" => ["td", "th", "tr"].contains(&of),
            "li" => of == "li" || of == "p",
            name => of == "p" && BLOCKS.contains(&name),
        };
        while open.last().is_some_and(|i| ends(&all[*i].name)) {
            open.pop();
        }
        let parent = open.last().copied();
        let within = parent.map_or("", |i| all[i].name.as_str());
        let fits = match name {
            "td" | "th" => within == "tr",
            "tr" => within == "table",
            "li" => within == "ul" || within == "ol",
            "figcaption" => within == "figure",
            "summary" => within == "details",
            "circle" | "rect" | "line" | "text" => within == "svg",
            _ => within != "p" || ["strong", "span", "em", "code", "br"].contains(&name),
        };
        if !fits {
            return Err(format!("<{name}> within <{within}>"));
        }
        all.push(Element {
            name: name.to_owned(),
            attributes: attributes(inner)?,
            text: String::new(),
            parent,
        });
        if name == "style" {
            let end = rest.find("</style>").ok_or("no end of <style>")?;
            rest = &rest[end + "</style>".len()..];
        } else if !closed && !VOID.contains(&name) {
            open.push(all.len() - 1);
        }
    }
    if !rest.trim().is_empty() || open.iter().any(|i| !LOOSE.contains(&all[*i].name.as_str())) {
        return Err(format!("open at the end: {open:?} {rest}"));
    }
    Ok(all)
}

/// A whole report: sound, with nothing that lies elsewhere, and every picture told in words.
pub fn check(page: &str) -> Vec<Element> {
    let all = read(page).unwrap_or_else(|fault| panic!("{fault}"));
    assert!(page.starts_with("<!doctype html><html lang=\"en\">"));
    assert!(!page.contains("url(") && !page.contains("<script") && !page.contains("@import"));
    let mut ids = BTreeSet::new();
    for element in &all {
        assert!(element.get("href").is_empty(), "{element:?}");
        let src = element.get("src");
        assert!(src.is_empty() || src.starts_with("data:image/png;base64,"));
        let id = element.get("id");
        assert!(id.is_empty() || ids.insert(id), "{id} twice");
        match element.name.as_str() {
            "img" => assert!(!element.get("alt").is_empty(), "{element:?}"),
            "svg" => {
                assert_eq!(element.get("role"), "img");
                assert!(element.get("aria-label").len() > 20, "{element:?}");
            }
            _ => {}
        }
        for (name, value) in &element.attributes {
            let bad = ["NaN", "inf"].iter().any(|bad| value.contains(bad));
            assert!(name == "src" || !bad, "{element:?}");
        }
    }
    all
}

#[test]
fn what_a_browser_would_guess_at_is_found() {
    assert!(read("<p>a<table><tr><td>b<td>c<tr><td>d</table>").is_ok());
    for wrong in [
        "<p>a</td>",
        "<figure><svg></figure></svg>",
        "<svg><rect x=\"1\" x=\"2\"/></svg>",
        "<p title=\"a & b\">c</p>",
        "<p>1 < 2</p>",
        "<table><td>a</table>",
        "<figure>",
        "<blink>a</blink>",
        "<p>a &nonsense b</p>",
        "<rect/>",
    ] {
        assert!(read(wrong).is_err(), "{wrong}");
    }
}
