//! Several machines that carry one wall: which of them this is, and who leads.

use std::{net::SocketAddr, time::Duration};

use super::Installation;
use crate::manifest::{Fault, Faults, Severity, did_you_mean, quote, quoted_list};

/// Where a machine learns its name, if the command line does not say it.
pub const MACHINE: &str = "RECTO_MACHINE";
/// How faults name what says it.
const ASKED: &str = "--machine";

/// Machines that carry one wall together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machines {
    /// Those that displays hang on, in the order of the displays.
    pub names: Vec<String>,
    /// One of `names`.
    pub lead: String,
    /// Where the others reach the one that leads.
    pub address: SocketAddr,
    /// How long after the leader the others show a picture.
    pub delay: Duration,
    /// After so long without a word a machine is lost.
    pub lost_after: Duration,
}

/// One of the machines: this one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machine {
    pub name: String,
    pub machines: Machines,
}

impl Machine {
    /// Whether hands touch this one.
    pub fn leads(&self) -> bool {
        self.name == self.machines.lead
    }

    /// Its place among the machines.
    pub fn index(&self) -> usize {
        let mut names = self.machines.names.iter();
        names.position(|name| *name == self.name).unwrap_or(0)
    }

    /// The installation as this machine has it: logs and status of its own, also where machines are
    /// processes of one computer, and scenes counted by the one that leads.
    pub fn own(&self, mut installation: Installation) -> Installation {
        if let Some(logs) = &mut installation.logs {
            logs.folder.push(&self.name);
            logs.usage_counts &= self.leads();
        }
        installation.status = installation.status.map(|address| self.status(address));
        installation
    }

    /// Where this machine's status is read, from where the installation says for all. Machines that are
    /// processes of one computer, to be tried there, take one port after the other.
    pub fn status(&self, address: SocketAddr) -> SocketAddr {
        let mut address = address;
        if self.machines.address.ip().is_loopback() {
            let by = u16::try_from(self.index()).unwrap_or(0);
            address.set_port(address.port().saturating_add(by));
        }
        address
    }
}

impl Installation {
    /// Which of its machines this one is: `asked`, or else the computer's own name `host`, where one is
    /// called so. `None` where one machine carries the wall alone.
    ///
    /// # Errors
    /// Where no machine is called so, or none can be told from the others.
    pub fn machine(
        &self,
        asked: Option<&str>,
        host: Option<&str>,
    ) -> Result<Option<Machine>, Faults> {
        let fault = |found: String, allowed: String, remedy: String| -> Faults {
            let fault = Fault {
                severity: Severity::Error,
                file: None,
                place: None,
                path: ASKED.into(),
                found,
                allowed,
                remedy,
                unreadable: false,
            };
            fault.into()
        };
        let Some(machines) = &self.machines else {
            return match asked {
                Some(name) => Err(fault(
                    quote(name),
                    format!("nothing, as {} has no [machines]", self.file.display()),
                    "remove it, or add [machines] to the installation file".to_owned(),
                )),
                None => Ok(None),
            };
        };
        let names = || machines.names.iter().map(String::as_str);
        let hosted = host.filter(|host| names().any(|name| name == *host));
        match asked.or(hosted) {
            Some(name) if names().any(|known| known == name) => Ok(Some(Machine {
                name: name.to_owned(),
                machines: machines.clone(),
            })),
            Some(name) => Err(fault(
                quote(name),
                quoted_list(names()),
                did_you_mean(name, names(), "name a machine of the installation file"),
            )),
            None => Err(fault(
                "nothing".to_owned(),
                quoted_list(names()),
                format!("say which machine this is, by --machine NAME or {MACHINE}=NAME"),
            )),
        }
    }
}
