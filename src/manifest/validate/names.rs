//! Ids: each once, and every reference to one that is there.

use std::collections::HashMap;

use super::super::{
    decode::Pattern,
    document::{Trail, Words},
    fault::{did_you_mean, one, quoted_list},
    raw::values::Id,
};
use super::Validator;

/// The ids of one list.
#[derive(Clone, Debug)]
pub(super) struct Names {
    /// What each element is, such as `lamp`.
    what: &'static str,
    /// With the index of each in the list.
    ids: Vec<(usize, String)>,
    /// The index of the first element with each id.
    indices: HashMap<String, usize>,
    /// Whether faulty elements, whose ids are unknown, are missing here.
    incomplete: bool,
}

impl Names {
    pub fn new<'i>(
        what: &'static str,
        ids: impl Iterator<Item = (usize, &'i Id)>,
        incomplete: bool,
    ) -> Self {
        let ids: Vec<_> = ids.map(|(i, id)| (i, id.as_str().to_owned())).collect();
        Self::of(what, ids, incomplete)
    }

    pub fn of_one(what: &'static str, id: &str) -> Self {
        Self::of(what, vec![(0, id.to_owned())], false)
    }

    pub fn of(what: &'static str, ids: Vec<(usize, String)>, incomplete: bool) -> Self {
        // In reverse, so that of two with one id the first stays.
        let indices = ids
            .iter()
            .rev()
            .map(|(index, id)| (id.clone(), *index))
            .collect();
        Self {
            what,
            ids,
            indices,
            incomplete,
        }
    }

    /// The same ids for something else.
    pub fn called(self, what: &'static str) -> Self {
        Self { what, ..self }
    }

    /// The only element's index, if there is just one.
    pub fn only(&self) -> Option<usize> {
        match self.ids[..] {
            [(index, _)] if !self.incomplete => Some(index),
            _ => None,
        }
    }

    /// Whether elements of the list are missing here because they are at fault.
    pub fn is_incomplete(&self) -> bool {
        self.incomplete
    }

    /// The first element's index.
    pub fn first(&self) -> Option<usize> {
        self.ids.first().map(|(index, _)| *index)
    }

    /// The index of the element with this id.
    pub fn position(&self, id: &str) -> Option<usize> {
        self.indices.get(id).copied()
    }

    /// The ids for a message, or the first of many.
    pub fn listed(&self) -> String {
        const SHOWN: usize = 20;
        match self.ids.len().saturating_sub(SHOWN) {
            0 => quoted_list(self.words()),
            more => {
                let shown: Vec<_> = self
                    .words()
                    .take(SHOWN)
                    .map(|word| format!("\"{word}\""))
                    .collect();
                format!("{} and {more} more", shown.join(", "))
            }
        }
    }

    pub fn words(&self) -> impl Iterator<Item = &str> {
        self.ids.iter().map(|(_, id)| id.as_str())
    }
}

impl Validator<'_, '_> {
    /// Reports every id that an earlier element of the list at `trail` has already.
    pub(super) fn unique(&mut self, names: &Names, trail: &Trail) {
        for (index, id) in &names.ids {
            if let Some(first) = names.position(id).filter(|first| first != index) {
                let words = Words::new(
                    format!("the id \"{id}\", which {} has already", trail.index(first)),
                    "ids that differ",
                    "rename one of the two",
                );
                self.report.fault(&trail.index(*index).key("id"), words);
            }
        }
    }

    /// The index that `id`, written at `trail`, refers to.
    pub(super) fn resolve(&mut self, id: &str, names: &Names, trail: &Trail) -> Option<usize> {
        let index = names.position(id);
        if index.is_none() && !names.incomplete && !self.report.is_full() {
            let what = one(names.what);
            let allowed = if names.ids.is_empty() {
                format!("the id of {what}, and there is none")
            } else {
                format!("the id of {what}: {}", names.listed())
            };
            let otherwise = format!("add {what} with this id or correct it");
            let remedy = did_you_mean(id, names.words(), &otherwise);
            self.report
                .fault(trail, Words::new(format!("\"{id}\""), allowed, remedy));
        }
        index
    }
}
