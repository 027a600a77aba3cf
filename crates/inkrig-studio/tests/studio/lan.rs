//! Other devices: a token once, then a cookie.

use crate::client::Studio;

#[test]
fn without_a_token_nothing_is_given() {
    let studio = Studio::with(true, None);
    let invitation = studio.invitation();
    let host = format!("studio.test:{}", studio.port);
    assert!(invitation.address.starts_with(&format!("http://{host}/?token=")), "{}", invitation.address);
    assert!(invitation.code.lines().count() > 10);
    let ask = |path: &str, headers: &[(&str, &str)]| studio.ask_as(&host, "GET", path, headers, b"");
    for path in [
        "/",
        "/api/project",
        "/api/live",
        "/api/events",
        "/assets/a.js",
        "/?token=",
        "/?token=00000000000000000000000000000000",
    ] {
        let answer = ask(path, &[]);
        assert_eq!(answer.status, 401, "{path}");
        assert!(answer.header("set-cookie").is_none());
        assert!(answer.header("content-security-policy").is_some());
    }
    assert_eq!(studio.ask("GET", "/api/project", &[], b"").status, 401, "nor on this machine");
    assert_eq!(studio.ask("GET", "/api/project", &[("Cookie", "inkrig=; inkrig=0")], b"").status, 401);

    let token = invitation.address.split("token=").nth(1).unwrap();
    // A token is for the page, not for the API.
    assert_eq!(ask(&format!("/api/project?token={token}"), &[]).status, 401);
    let taken =
        ask(&format!("/?token={token}"), &[("Sec-Fetch-Site", "none"), ("Sec-Fetch-Mode", "navigate")]);
    assert_eq!((taken.status, taken.header("location")), (303, Some("/")), "it leaves the address bar");
    let cookie = taken.header("set-cookie").unwrap().to_string();
    assert!(cookie.contains("HttpOnly") && cookie.contains("SameSite=Strict"), "{cookie}");
    let pair = cookie.split(';').next().unwrap();
    assert!(!pair.contains(token));
    assert_eq!(ask("/api/project", &[("Cookie", pair)]).status, 200);
    let page = ask("/", &[("Cookie", pair)]);
    assert_eq!(
        page.header("cross-origin-opener-policy"),
        None,
        "a browser complains of it on such an address"
    );
    assert_eq!(ask("/api/project", &[("Cookie", &format!("a=b; {pair}; c=d"))]).status, 200);
    assert_eq!(ask(&format!("/?token={token}"), &[]).status, 401, "it is spent");
    assert_eq!(ask("/api/project", &[("Cookie", pair), ("Origin", "http://evil.example")]).status, 403);
    assert_eq!(studio.ask_as("evil.example", "GET", "/api/project", &[("Cookie", pair)], b"").status, 403);
    // The next device gets a token of its own.
    let next = studio.invitation();
    assert_ne!(next.address, invitation.address);
}
