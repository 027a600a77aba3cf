//! A sweep as one page that needs nothing else, and as text.

use super::sweep::{Sweep, SweptCell};
use crate::printable;
use crate::sheet::SheetError;
use base64::prelude::{BASE64_STANDARD, Engine};
use std::fmt::Write;

const STYLE: &str = "body{font:14px/1.4 system-ui,sans-serif;margin:24px;background:#fff;color:#222}\
table{border-collapse:collapse}td,th{padding:6px;vertical-align:top;text-align:left;font-weight:normal}\
th{color:#555}img{display:block}img.d{image-rendering:pixelated;width:156px}small{font-variant-numeric:tabular-nums}\
.own{outline:2px solid #d6483c}\
@media(prefers-color-scheme:dark){body{background:#14161a;color:#ddd}th{color:#aaa}}";

/// The page.
///
/// # Errors
/// When a picture cannot be written as PNG.
pub fn page(sweep: &Sweep) -> Result<String, SheetError> {
    let mut text = format!(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>What the parameters do</title>\
         <style>{STYLE}</style><h1>What the parameters do</h1><p>{}. Each picture shows the distances within a motion, dark \
         where two moments are alike; the control's own stand first. What align takes by itself is framed.</p>",
        escaped(&sweep.machine.to_string())
    );
    // Writing to a string cannot fail.
    for swept in &sweep.parameters {
        let _ = write!(text, "<h2>{}</h2><table><tr><th>control", swept.parameter.name());
        for value in swept.parameter.values() {
            let _ = write!(text, "<th>{value}");
        }
        for case in &swept.cases {
            let control = image(&case.control.png()?, "d", "distances within the control");
            let _ = write!(text, "<tr><td>{control}<small>{}</small>", escaped(&case.case));
            for cell in &case.cells {
                let own = if (cell.value - case.default).abs() < 1e-9 { " class=\"own\"" } else { "" };
                let (result, poses) = (
                    image(&cell.result.png()?, "d", "distances within the result"),
                    image(&cell.poses, "p", "poses of the result"),
                );
                let _ = write!(text, "<td{own}>{result}{poses}<small>{}</small>", figures(cell));
            }
        }
        text.push_str("</table>");
    }
    text.push_str("</html>\n");
    Ok(text)
}

/// The figures of a sweep as Markdown tables, one for each parameter.
pub fn sweep_markdown(sweep: &Sweep) -> String {
    let mut text = format!("{}\n", sweep.machine);
    for swept in &sweep.parameters {
        let name = swept.parameter.name();
        let _ = write!(
            text,
            "\n| case | {name} | structure | nearest | coverage | jump | speed | jerk | freeze |\n\
             |---|---:|---:|---:|---:|---:|---:|---:|---:|\n"
        );
        for case in &swept.cases {
            for cell in &case.cells {
                let quality = &cell.quality;
                let own = if (cell.value - case.default).abs() < 1e-9 { " (default)" } else { "" };
                let _ = writeln!(
                    text,
                    "| {} | {}{own} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} |",
                    printable::text(&case.case).replace('|', "\\|").replace('\n', " "),
                    cell.value,
                    quality.structure_pearson,
                    quality.nearest_patch,
                    quality.coverage,
                    quality.jump_q999_ratio,
                    quality.speed_mean_ratio,
                    quality.jerk_ratio,
                    quality.freeze
                );
            }
        }
    }
    text
}

fn figures(cell: &SweptCell) -> String {
    let quality = &cell.quality;
    format!(
        "structure {:.2}, nearest {:.2}<br>jump {:.2}, speed {:.2}<br>coverage {:.2}, freeze {:.2}",
        quality.structure_pearson,
        quality.nearest_patch,
        quality.jump_q999_ratio,
        quality.speed_mean_ratio,
        quality.coverage,
        quality.freeze
    )
}

fn image(png: &[u8], class: &str, what: &str) -> String {
    format!(
        "<img class=\"{class}\" alt=\"{what}\" src=\"data:image/png;base64,{}\">",
        BASE64_STANDARD.encode(png)
    )
}

fn escaped(text: &str) -> String {
    printable::text(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
