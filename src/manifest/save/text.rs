//! Tables of a text, found and changed in place: bytes outside them stay what they are.

use std::ops::Range;

use toml_edit::{Document, DocumentMut, Item, Table, Value};

/// A text of TOML with the places of what is in it.
pub struct Source<'t> {
    text: &'t str,
    document: Document<&'t str>,
    /// Where the headers of its tables begin, in order.
    headers: Vec<usize>,
}

/// Why a list cannot be edited: its name, and how it is written.
pub type Form = (&'static str, &'static str);

/// The tables of one list, each below its own header.
pub struct Tables<'t> {
    text: &'t str,
    list: &'static str,
    blocks: Vec<Block>,
}

/// One table of a list.
struct Block {
    id: String,
    /// From the line of its header to that of its last value, both whole.
    lines: Range<usize>,
    /// Nothing of another table stands in between.
    whole: bool,
}

/// What takes the place of a part of a text.
pub struct Edit {
    at: Range<usize>,
    text: String,
}

impl<'t> Source<'t> {
    pub fn read(text: &'t str) -> Result<Self, String> {
        let document = Document::parse(text).map_err(|error| error.to_string())?;
        let mut marks = Marks::default();
        marks.table(document.as_table());
        marks.headers.sort_unstable();
        Ok(Self {
            text,
            document,
            headers: marks.headers,
        })
    }

    /// The tables of the list `[[list]]`.
    pub fn tables(&self, list: &'static str) -> Result<Tables<'t>, Form> {
        let tables = match self.document.get(list) {
            None => None,
            Some(Item::ArrayOfTables(tables)) => Some(tables),
            Some(_) => return Err((list, "it is written in one line, in square brackets")),
        };
        let blocks = tables.into_iter().flat_map(|tables| tables.iter());
        let blocks = blocks.map(|table| self.block(table)).collect();
        Ok(Tables {
            text: self.text,
            list,
            blocks,
        })
    }

    fn block(&self, table: &Table) -> Block {
        let mut marks = Marks::default();
        marks.header(table);
        marks.table(table);
        let start = marks.headers.iter().copied().min().unwrap_or_default();
        let last = marks.ends.iter().copied().max().unwrap_or_default();
        let within = self.headers.iter().filter(|at| (start..last).contains(at));
        Block {
            id: table
                .get("id")
                .and_then(Item::as_str)
                .unwrap_or_default()
                .to_owned(),
            lines: line_start(self.text, start)..line_end(self.text, last),
            whole: within.count() == marks.headers.len(),
        }
    }

    /// The text with these edits, which do not overlap.
    pub fn with(&self, mut edits: Vec<Edit>) -> String {
        // Of two at one place the first comes first.
        edits.sort_by_key(|edit| edit.at.start);
        let (mut text, mut done) = (String::new(), 0);
        for edit in edits {
            text.push_str(&self.text[done..edit.at.start]);
            if !text.is_empty() && !text.ends_with('\n') {
                text.push_str(newline(self.text));
            }
            text.push_str(&edit.text);
            done = edit.at.end;
        }
        text + &self.text[done..]
    }
}

/// Where headers begin, and where headers and values end.
#[derive(Default)]
struct Marks {
    headers: Vec<usize>,
    ends: Vec<usize>,
}

impl Marks {
    fn header(&mut self, table: &Table) {
        if let Some(span) = table.span() {
            self.headers.push(span.start);
            self.ends.push(span.end);
        }
    }

    fn table(&mut self, table: &Table) {
        for (_, item) in table {
            match item {
                Item::None => {}
                Item::Value(value) => self.ends.extend(value.span().map(|span| span.end)),
                Item::Table(table) => {
                    if !table.is_implicit() && !table.is_dotted() {
                        self.header(table);
                    }
                    self.table(table);
                }
                Item::ArrayOfTables(tables) => {
                    for table in tables {
                        self.header(table);
                        self.table(table);
                    }
                }
            }
        }
    }
}

impl Tables<'_> {
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// The index of the table with this id.
    pub fn position(&self, id: &str) -> Option<usize> {
        self.blocks.iter().position(|block| block.id == id)
    }

    /// More tables behind the last one, or at the end of the text where there is none.
    pub fn appended(&self, tables: &[Table]) -> Option<Edit> {
        if tables.is_empty() {
            return None;
        }
        let at = match self.blocks.iter().map(|block| block.lines.end).max() {
            Some(end) => behind_its_comments(self.text, end),
            None => self.text.len(),
        };
        let mut text = String::new();
        for table in tables {
            if at > 0 || !text.is_empty() {
                text.push('\n');
            }
            text += &format!("[[{}]]\n{}", self.list, DocumentMut::from(table.clone()));
        }
        Some(Edit {
            at: at..at,
            text: self.with_its_newlines(text),
        })
    }

    /// `table` in place of the one with this index. Its keys that say the same, and those of
    /// `kept`, stay as they are written.
    pub fn replaced(&self, index: usize, table: &Table, kept: &[&str]) -> Result<Edit, Form> {
        let Block { lines, whole, .. } = &self.blocks[index];
        let scattered = (
            self.list,
            "the parts of one stand apart, with others in between",
        );
        if !whole {
            return Err(scattered);
        }
        let text = self.text[lines.clone()].replace("\r\n", "\n");
        let mut document: DocumentMut = text.parse().map_err(|_| scattered)?;
        let list = document.get_mut(self.list);
        let old = list
            .and_then(Item::as_array_of_tables_mut)
            .and_then(|tables| tables.get_mut(0))
            .ok_or(scattered)?;
        let keys: Vec<String> = old.iter().map(|(key, _)| key.to_owned()).collect();
        for key in keys {
            if !table.contains_key(&key) {
                old.remove(&key);
            }
        }
        for (key, new) in table {
            let there = old.get(key);
            if there.is_some_and(|there| kept.contains(&key) || same(there, new)) {
                continue;
            }
            match (old.get_mut(key), new) {
                (Some(Item::Value(there)), Item::Value(new)) => {
                    let decor = there.decor().clone();
                    *there = new.clone();
                    *there.decor_mut() = decor;
                }
                _ => {
                    // A table with a header of its own becomes a value of the scene's.
                    old.remove(key);
                    old.insert(key, new.clone());
                }
            }
        }
        Ok(Edit {
            at: lines.clone(),
            text: self.with_its_newlines(document.to_string()),
        })
    }

    fn with_its_newlines(&self, text: String) -> String {
        match newline(self.text) {
            "\n" => text,
            newline => text.replace('\n', newline),
        }
    }
}

/// Whether two items say the same, however they are written.
fn same(a: &Item, b: &Item) -> bool {
    let numbers = |a: &Item| {
        let value = a.as_value()?;
        value
            .as_float()
            .or_else(|| value.as_integer().map(|i| i as f64))
    };
    if let (Some(a), Some(b)) = (numbers(a), numbers(b)) {
        return a == b;
    }
    if let (Some(a), Some(b)) = (a.as_str(), b.as_str()) {
        return a == b;
    }
    if let (Some(a), Some(b)) = (a.as_table_like(), b.as_table_like()) {
        let in_both = |(key, a): (&str, &Item)| b.get(key).is_some_and(|b| same(a, b));
        return a.len() == b.len() && a.iter().all(in_both);
    }
    let values = |a: &Item| -> Option<Vec<Value>> { Some(a.as_array()?.iter().cloned().collect()) };
    if let (Some(a), Some(b)) = (values(a), values(b)) {
        let pair = |(a, b): (Value, Value)| same(&Item::Value(a), &Item::Value(b));
        return a.len() == b.len() && a.into_iter().zip(b).all(pair);
    }
    false
}

/// How lines end in a text.
fn newline(text: &str) -> &'static str {
    match text.contains("\r\n") {
        true => "\r\n",
        false => "\n",
    }
}

fn line_start(text: &str, at: usize) -> usize {
    text[..at].rfind('\n').map_or(0, |newline| newline + 1)
}

/// Behind the end of the line that `at` lies in.
fn line_end(text: &str, at: usize) -> usize {
    text[at..]
        .find('\n')
        .map_or(text.len(), |newline| at + newline + 1)
}

/// Behind comments that follow a table at once, unless something else follows them at once.
fn behind_its_comments(text: &str, table_end: usize) -> usize {
    let mut end = table_end;
    for line in text[table_end..].split_inclusive('\n') {
        match line.trim_start() {
            "" => return end,
            comment if comment.starts_with('#') => end += line.len(),
            _ => return table_end,
        }
    }
    end
}
