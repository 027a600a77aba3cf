//! Addresses by which other devices find this machine.

use std::net::{IpAddr, Ipv4Addr, UdpSocket};

/// Its address in the local network; that of loopback where there is none.
pub(super) fn of_this_machine() -> String {
    // Nothing is sent: the system says from where it would be.
    let found = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).and_then(|socket| {
        socket.connect((Ipv4Addr::new(192, 0, 2, 1), 9))?;
        socket.local_addr()
    });
    let address = found.map(|address| address.ip()).unwrap_or(IpAddr::V4(Ipv4Addr::LOCALHOST));
    address.to_string()
}

/// The names that it calls itself.
pub(super) fn names() -> Vec<String> {
    let name = std::fs::read_to_string("/etc/hostname").unwrap_or_default().trim().to_string();
    if name.is_empty() { Vec::new() } else { vec![format!("{name}.local"), name] }
}
