//! The page that shows what is in a corpus and what is not.

use super::config::{Config, Split};
use super::manifest::{Entry, RejectedEntry};
use inkrig_motion::humanml::FRAME_RATE;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The most clips that are listed one by one.
const MOST_ROWS: usize = 2000;

/// The page as HTML.
pub(super) fn page(config: &Config, entries: &[Entry], rejected: &[RejectedEntry]) -> String {
    let mut out = String::from(HEAD);
    let minutes = |entries: &mut dyn Iterator<Item = &Entry>| {
        let frames: usize = entries.map(|entry| entry.frames).sum();
        frames as f64 / FRAME_RATE / 60.0
    };
    let total = minutes(&mut entries.iter());
    _ = write!(
        out,
        "<p class=sum><b>{total:.1} minutes</b> in {} clips, and as much again of mirror images; {} clips left out.</p>",
        entries.len(),
        rejected.len()
    );

    out.push_str("<h2>Sources</h2><table><tr><th>Source<th>Licence<th>Clips<th>Train, min<th>Val<th>Test<th>Left out<th>Credit</tr>");
    for source in &config.sources {
        let own = || entries.iter().filter(|entry| entry.source == source.name);
        _ = write!(out, "<tr><td>{}<td>{}<td>{}", text(&source.name), text(&source.licence), own().count());
        for split in Split::ALL {
            _ = write!(out, "<td>{:.1}", minutes(&mut own().filter(|entry| entry.split == split)));
        }
        let bad = rejected.iter().filter(|entry| entry.source == source.name).count();
        _ = write!(out, "<td>{bad}<td class=words>{}</tr>", text(&source.credit));
    }
    out.push_str("</table>");

    let mut by_licence: BTreeMap<&str, f64> = BTreeMap::new();
    let mut by_action: BTreeMap<&str, (f64, usize)> = BTreeMap::new();
    let mut wordless = 0;
    for entry in entries {
        *by_licence.entry(&entry.licence).or_default() += entry.frames as f64 / FRAME_RATE / 60.0;
        wordless += usize::from(entry.actions.is_empty());
        for action in &entry.actions {
            let row = by_action.entry(action).or_default();
            row.0 += entry.frames as f64 / FRAME_RATE / 60.0;
            row.1 += 1;
        }
    }
    out.push_str("<h2>Licences</h2><table><tr><th>Class<th>Minutes<th></tr>");
    let most = by_licence.values().copied().fold(0.0, f64::max);
    for (licence, minutes) in &by_licence {
        bar(&mut out, licence, &format!("{minutes:.1}"), minutes / most);
    }
    _ = write!(
        out,
        "</table><h2>Actions</h2><p>A clip counts for every action that its words name; {wordless} name none that is known.</p>\
         <table><tr><th>Action<th>Minutes (clips)<th></tr>"
    );
    let mut actions: Vec<_> = by_action.into_iter().collect();
    actions.sort_by(|a, b| b.1.0.total_cmp(&a.1.0));
    let most = actions.first().map_or(1.0, |(_, (minutes, _))| *minutes);
    for (action, (minutes, clips)) in &actions {
        bar(&mut out, action, &format!("{minutes:.1} ({clips})"), minutes / most);
    }

    out.push_str("</table><h2>Left out</h2><table><tr><th>Reason<th>Clips<th></tr>");
    let mut kinds: BTreeMap<&str, usize> = BTreeMap::new();
    rejected.iter().for_each(|entry| *kinds.entry(&entry.kind).or_default() += 1);
    let most = kinds.values().copied().max().unwrap_or(1) as f64;
    for (kind, count) in &kinds {
        bar(&mut out, kind, &count.to_string(), *count as f64 / most);
    }
    out.push_str("</table><details><summary>Every clip that was left out</summary><table><tr><th>Source<th>File<th>Clip<th>Why</tr>");
    for entry in rejected.iter().take(MOST_ROWS) {
        let clip = entry.clip.as_deref().unwrap_or_default();
        _ = write!(
            out,
            "<tr><td>{}<td>{}<td>{}<td class=words>{}</tr>",
            text(&entry.source),
            text(&entry.file),
            text(clip),
            text(&entry.why)
        );
    }
    out.push_str("</table></details><details><summary>Every clip</summary><table><tr><th>Source<th>File<th>Clip<th>Split<th>Seconds<th>Words<th>Actions</tr>");
    for entry in entries.iter().take(MOST_ROWS) {
        _ = write!(
            out,
            "<tr><td>{}<td>{}<td>{}<td>{}<td>{:.1}<td class=words>{}<td class=words>{}</tr>",
            text(&entry.source),
            text(&entry.file),
            text(entry.clip.as_deref().unwrap_or_default()),
            entry.split.name(),
            entry.frames as f64 / FRAME_RATE,
            text(&entry.text),
            text(&entry.actions.join(", "))
        );
    }
    out.push_str("</table></details></main></html>\n");
    out
}

fn bar(out: &mut String, name: &str, count: &str, share: f64) {
    let width = (100.0 * share.clamp(0.0, 1.0)).round();
    _ = write!(
        out,
        "<tr><td>{}<td>{}<td class=bar><i style=\"width:{width}%\"></i></tr>",
        text(name),
        text(count)
    );
}

/// Text from files, so that it is text in a page as well.
fn text(raw: &str) -> String {
    let mut out = String::with_capacity(raw.len());
    for letter in raw.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            letter if letter.is_control() => out.push(' '),
            letter => out.push(letter),
        }
    }
    out
}

const HEAD: &str = "<!doctype html><html lang=en><meta charset=utf-8>\
<meta http-equiv=Content-Security-Policy content=\"default-src 'none'; style-src 'unsafe-inline'\">\
<meta name=viewport content=\"width=device-width\"><title>Corpus</title><style>\
:root{color-scheme:light dark}body{font:15px/1.5 system-ui,sans-serif;margin:0;background:Canvas;color:CanvasText}\
main{max-width:62rem;margin:2rem auto;padding:0 1rem}h1{font-size:1.5rem}h2{font-size:1.1rem;margin-top:2rem}\
table{border-collapse:collapse;width:100%}th{text-align:left;font-weight:600;border-bottom:1px solid #8888}\
td,th{padding:.25rem .8rem .25rem 0;vertical-align:top;white-space:nowrap;font-variant-numeric:tabular-nums}\
td.words{white-space:normal}td.bar{width:60%;vertical-align:middle}td.bar i{display:block;height:.7rem;border-radius:2px;background:#4a7dbd}\
summary{cursor:pointer;margin-top:1rem}.sum{font-size:1.1rem}details{overflow-x:auto}</style><main><h1>Corpus</h1>";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_are_no_markup() {
        let config: Config = toml::from_str("[[source]]\nname='a'\nfolder='x'\nlicence='<b>'\n").unwrap();
        let bad = RejectedEntry {
            source: "a".into(),
            file: "<script>alert(1)</script>\u{1b}[2J".into(),
            clip: None,
            kind: "k".into(),
            why: "a \"quote\"".into(),
        };
        let page = page(&config, &[], &[bad]);
        assert!(!page.contains("<script") && !page.contains("<b>&") && !page.contains('\u{1b}'));
        assert!(page.contains("&lt;script&gt;") && page.contains("&quot;quote&quot;"));
    }
}
