//! Machines: each display hangs on one of them, and one of them leads.

use std::{net::SocketAddr, time::Duration};

use super::{
    super::{
        Machines,
        raw::{RawInstallation, RawMachines},
    },
    Validator,
};
use crate::manifest::{
    Pattern,
    document::{Trail, Words},
    quote, quoted_list,
};

/// How long after the leader other machines show a picture, unless somebody says otherwise: longer than
/// the unevenness of a cable, and shorter than a frame.
const DELAY: Duration = Duration::from_millis(10);
const LOST_AFTER: Duration = Duration::from_secs(5);

impl Validator<'_, '_> {
    pub(super) fn machines(&mut self, raw: &RawInstallation, root: &Trail) -> Option<Machines> {
        let trail = root.key("machines");
        let displays = raw.display.iter().flat_map(|list| list.iter());
        let mut names: Vec<String> = Vec::new();
        for (i, display) in displays {
            let trail = root.key("display").index(i);
            match (&display.machine, &raw.machines) {
                (Some(machine), Some(_)) => {
                    let name = machine.as_str();
                    if names.iter().all(|known| known != name) {
                        names.push(name.to_owned());
                    }
                }
                (Some(machine), None) => {
                    let words = Words::new(
                        format!("{} without [machines]", quote(machine.as_str())),
                        "it together with [machines]",
                        "add [machines] with lead and address, or remove it",
                    );
                    self.report.fault(&trail.key("machine"), words);
                }
                (None, Some(_)) => {
                    let words = Words::new(
                        "no machine, where there are several",
                        "the machine that it is plugged into",
                        "add machine = \"…\"",
                    );
                    self.report.fault(&trail, words);
                }
                (None, None) => {}
            }
        }
        let raw_machines = raw.machines.as_ref()?;
        if raw.display.is_none() {
            let words = Words::new(
                "machines without a display",
                "them together with [[display]]",
                "add each [[display]] with its machine, or remove [machines]",
            );
            self.report.fault(&trail, words);
            return None;
        }
        let lead = raw_machines.lead.as_str();
        if !names.is_empty() && names.iter().all(|name| name != lead) {
            let words = Words::new(
                quote(lead),
                quoted_list(names.iter().map(String::as_str)),
                "name a machine that a display is plugged into",
            );
            self.report.fault(&trail.key("lead"), words);
        }
        if let [alone] = &names[..] {
            let words = Words::new(
                format!("{} alone", quote(alone)),
                "two machines or more",
                "give each display its machine, or remove [machines]",
            );
            self.report.warn(&trail, words);
        }
        let address = self.leaders_address(raw_machines, &trail)?;
        Some(Machines {
            names,
            lead: lead.to_owned(),
            address,
            delay: raw_machines
                .delay_ms
                .map_or(DELAY, |ms| Duration::from_secs_f64(ms.0 / 1e3)),
            lost_after: raw_machines
                .lost_after_seconds
                .map_or(LOST_AFTER, |s| Duration::from_secs_f64(s.0)),
        })
    }

    /// Where it can be reached, and only as far as that is meant.
    fn leaders_address(&mut self, raw: &RawMachines, trail: &Trail) -> Option<SocketAddr> {
        let text = raw.address.as_str();
        let trail = trail.key("address");
        let Ok(address) = text.parse::<SocketAddr>() else {
            let words = Words::new(
                quote(text),
                "the leader's address and a port such as \"192.168.1.10:7447\"",
                "write numbers, a colon and the port",
            );
            self.report.fault(&trail, words);
            return None;
        };
        let meant = raw.beyond_this_machine == Some(true);
        let ip = address.ip();
        let words = if address.port() == 0 {
            Words::new("port 0", "ports from 1 to 65535", "write another port")
        } else if ip.is_unspecified() || ip.is_multicast() {
            Words::new(
                format!("{}, which is nobody's own", quote(text)),
                "the address by which the others reach the machine that leads",
                "write that machine's own address in the network of the wall",
            )
        } else if !ip.is_loopback() && !meant {
            Words::new(
                format!("{}, which other machines reach", quote(text)),
                "addresses that only this machine reaches, such as \"127.0.0.1:7447\"",
                "add beyond_this_machine = true if that is meant: whoever reaches it can show what it \
                 likes on the wall",
            )
        } else if ip.is_loopback() && meant {
            let words = Words::new(
                format!("{}, which only this machine reaches", quote(text)),
                "an address of the leader in its network, such as \"192.168.1.10:7447\"",
                "change it, or remove beyond_this_machine to try machines as processes of one",
            );
            self.report.warn(&trail, words);
            return Some(address);
        } else {
            return Some(address);
        };
        self.report.fault(&trail, words);
        None
    }
}
