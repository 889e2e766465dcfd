//! What several test files share.

use std::{
    io::{self, Write},
    path::PathBuf,
};

/// A file or folder of the shared test data (`$RECTO_DATA`, or `../shared/data` beside the
/// checkout). Where the whole data folder is absent, says that `test` is skipped and returns
/// `None`; a missing file inside it fails the test.
pub fn data(test: &str, path: &str) -> Option<PathBuf> {
    let root = match std::env::var_os("RECTO_DATA") {
        Some(root) => PathBuf::from(root),
        None => PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/data")),
    };
    if !root.is_dir() {
        // `cargo test` shows what passing tests print only if it did not go through a macro.
        let _ = writeln!(
            io::stderr(),
            "skipped: {test} needs the test data, which is not in {}",
            root.display()
        );
        return None;
    }
    let found = root.join(path);
    assert!(
        found.exists(),
        "{} is missing from the test data",
        found.display()
    );
    Some(found)
}

/// The module path and name of the test that calls it, for [`data`].
#[macro_export]
macro_rules! test_name {
    () => {{
        fn here() {}
        std::any::type_name_of_val(&here).trim_end_matches("::here")
    }};
}
