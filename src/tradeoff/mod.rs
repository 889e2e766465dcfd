//! The price of accuracy: how far each tier is from the judge, and which tier serves a scene.
//!
//! | step | where |
//! |---|---|
//! | what is judged: nine subjects, their light and eyes | [`subject`] |
//! | what the random walk finds of them, baked | [`judged`] |
//! | tiers against it | [`errors`] |
//! | all of it as CSV, and the table that is part of the program | [`table`] |
//! | what study errs by between the subjects | [`correction`] |
//! | what lies at each place of a side | [`places`] |
//! | tiers on a scene, predicted | [`scene`] |
//! | the tier for a scene, at rest and in motion | [`choice`] |
//! | the picture of the table | [`plot`] |
//!
//! What tiers cost is measured by [`crate::cost`].

pub mod choice;
pub mod correction;
pub mod errors;
pub mod judged;
pub mod places;
pub mod plot;
pub mod scene;
pub mod subject;
pub mod table;
