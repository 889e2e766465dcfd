//! Ids: each once, and every reference to one that is there.

use super::super::{
    decode::Pattern,
    document::{Trail, Words},
    fault::{did_you_mean, quoted_list},
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
    /// Whether faulty elements, whose ids are unknown, are missing here.
    incomplete: bool,
}

impl Names {
    pub fn new<'i>(
        what: &'static str,
        ids: impl Iterator<Item = (usize, &'i Id)>,
        incomplete: bool,
    ) -> Self {
        let ids = ids.map(|(i, id)| (i, id.as_str().to_owned())).collect();
        Self {
            what,
            ids,
            incomplete,
        }
    }

    pub fn of_one(what: &'static str, id: &str) -> Self {
        Self {
            what,
            ids: vec![(0, id.to_owned())],
            incomplete: false,
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
        self.ids
            .iter()
            .find(|(_, name)| name == id)
            .map(|(index, _)| *index)
    }

    pub fn words(&self) -> impl Iterator<Item = &str> {
        self.ids.iter().map(|(_, id)| id.as_str())
    }
}

impl Validator<'_, '_> {
    /// Reports every id that an earlier element of the list at `trail` has already.
    pub(super) fn unique(&mut self, names: &Names, trail: &Trail) {
        for (position, (index, id)) in names.ids.iter().enumerate() {
            let earlier = names.ids[..position]
                .iter()
                .find(|(_, earlier)| earlier == id);
            if let Some((first, _)) = earlier {
                let words = Words::new(
                    format!("the id \"{id}\", which {} has already", trail.index(*first)),
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
        if index.is_none() && !names.incomplete {
            let what = names.what;
            let allowed = if names.ids.is_empty() {
                format!("the id of a {what}, and there is none")
            } else {
                format!("the id of a {what}: {}", quoted_list(names.words()))
            };
            let otherwise = format!("add a {what} with this id or correct it");
            let remedy = did_you_mean(id, names.words(), &otherwise);
            self.report
                .fault(trail, Words::new(format!("\"{id}\""), allowed, remedy));
        }
        index
    }
}
