//! Commands of the contract that this version does not have yet: they say so, and never succeed.

use std::ffi::OsString;

use clap::Subcommand;

use super::Failure;

/// What help says about them.
pub const HELP: &str = "Not in this version yet: import, export.";

/// Whatever follows the command.
#[derive(clap::Args)]
#[command(disable_help_flag = true)]
pub struct Anything {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    _arguments: Vec<OsString>,
}

macro_rules! commands {
    ($($(#[doc = $doc:literal])+ $name:ident = $word:literal,)+) => {
        #[derive(Subcommand)]
        pub enum Command {
            $($(#[doc = $doc])+ #[command(hide = true)] $name(Anything),)+
        }

        impl Command {
            fn word(&self) -> &'static str {
                match self {
                    $(Self::$name(_) => $word,)+
                }
            }
        }
    };
}

commands! {
    /// Import from IIIF, Relight or RTI
    Import = "import",
    /// Export to IIIF
    Export = "export",
}

impl Command {
    /// Why nothing was done.
    pub fn refusal(&self) -> Failure {
        not_yet(&format!("the command {}", self.word()))
    }
}

/// Why `what`, a part of the contract, was not done.
pub fn not_yet(what: &str) -> Failure {
    Failure::Usage(format!(
        "{what} comes with a later version; {} does not have it yet",
        env!("CARGO_PKG_VERSION")
    ))
}
