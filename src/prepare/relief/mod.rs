//! Relief: from normals to the sheet's shape at large, and what is smaller.
//!
//! | step | where |
//! |---|---|
//! | normals → shape, and grain and strokes | [`filter`] |
//! | normals → heights | [`integrate`] |
//! | cosine and sine transforms | `transform` |
//! | in double precision or in single | `real` |
//! | heights of two surfaces, and their planes | [`compare`] |
//! | heights → mesh, and another surface → heights | [`surface`] |

pub mod compare;
pub mod filter;
pub mod integrate;
pub(super) mod real;
pub mod surface;
mod transform;
