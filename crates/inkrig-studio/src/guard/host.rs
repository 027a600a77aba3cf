//! Names under which the studio may be opened.

use std::net::IpAddr;

/// Names that are known.
#[derive(Debug)]
pub(super) struct Hosts {
    port: u16,
    names: Vec<String>,
    /// Any address is, since no name of others hides behind an address.
    addresses: bool,
}

impl Hosts {
    pub(super) fn new(port: u16, names: Vec<String>, addresses: bool) -> Self {
        let names = names.into_iter().map(|name| name.to_ascii_lowercase()).collect();
        Self { port, names, addresses }
    }

    /// Whether a Host header names the studio: name or address, and the port.
    pub(super) fn knows(&self, host: &str) -> bool {
        let (name, port) = match host.rsplit_once(':') {
            // The colons of an address without a port.
            Some((_, rest)) if rest.ends_with(']') => (host, None),
            Some((name, port)) => (name, Some(port)),
            None => (host, None),
        };
        let good_port = match port {
            None => self.port == 80,
            Some(port) => port.bytes().all(|byte| byte.is_ascii_digit()) && port.parse() == Ok(self.port),
        };
        let name = name.to_ascii_lowercase();
        let address = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(&name);
        let known = match address.parse::<IpAddr>() {
            Ok(address) => address.is_loopback() || self.addresses,
            Err(_) => name == "localhost" || self.names.contains(&name),
        };
        good_port && known
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_this_machine() {
        let hosts = Hosts::new(4747, vec!["Atelier.local".into()], false);
        for good in ["localhost:4747", "127.0.0.1:4747", "[::1]:4747", "LOCALHOST:4747", "atelier.local:4747"]
        {
            assert!(hosts.knows(good), "{good}");
        }
        for bad in [
            "localhost",
            "localhost:80",
            "127.0.0.1:+4747",
            "localhost.evil.example:4747",
            "192.168.1.5:4747",
            "[::1]",
            ":4747",
            "",
            "127.0.0.1.evil:4747",
            "evil@localhost:4747",
        ] {
            assert!(!hosts.knows(bad), "{bad}");
        }
        let lan = Hosts::new(80, Vec::new(), true);
        assert!(lan.knows("192.168.1.5") && lan.knows("[fe80::1]") && lan.knows("[fe80::1]:80"));
        assert!(!lan.knows("evil.example"));
    }
}
