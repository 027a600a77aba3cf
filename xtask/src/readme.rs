//! Runs the commands of README.md on the built program, so that the page stays true.
//!
//! Commands in fenced blocks marked `sh` run in order, in an empty folder. Lines for the program count, written as
//! `inkrig ...` or `cargo run --release -- ...`; others (cloning, installing) are left alone. A command with a name to
//! fill in belongs in a block marked `text`.

use std::fs;
use std::process::Command;

use anyhow::{Context as _, Result, bail};

use crate::tools::Context;
use crate::{demo, process, test};

/// Runs each command; the first that fails is the error.
pub(crate) fn check(context: &Context) -> Result<()> {
    let readme = fs::read_to_string(context.root.join("README.md")).context("cannot read README.md")?;
    let target = context.target()?;
    let program = test::built_program(&target)?;
    let folder = target.join("readme");
    demo::empty(&folder)?;
    let commands = commands(&readme)?;
    if commands.is_empty() {
        bail!("README.md shows no command of the program in a block marked sh");
    }
    for arguments in &commands {
        process::run(Command::new(&program).args(arguments).current_dir(&folder))?;
    }
    Ok(())
}

/// The arguments of each command for the program, in the order of the page.
fn commands(page: &str) -> Result<Vec<Vec<String>>> {
    let mut commands = Vec::new();
    let mut block: Option<&str> = None;
    let mut unfinished = String::new();
    for line in page.lines() {
        if let Some(mark) = line.trim_start().strip_prefix("```") {
            block = if block.is_some() { None } else { Some(mark.trim()) };
        } else if block == Some("sh") {
            let line = line.trim();
            if let Some(start) = line.strip_suffix('\\') {
                unfinished.push_str(start);
                continue;
            }
            let whole = std::mem::take(&mut unfinished) + line;
            let words = words(&whole).with_context(|| format!("README.md: {whole}"))?;
            commands.extend(for_program(&words).map(<[String]>::to_vec));
        }
    }
    Ok(commands)
}

fn for_program(words: &[String]) -> Option<&[String]> {
    let is = |start: &[&str]| words.iter().map(String::as_str).take(start.len()).eq(start.iter().copied());
    [&["inkrig"][..], &["cargo", "run", "--release", "--"][..]]
        .into_iter()
        .find(|start| is(start))
        .and_then(|start| words.get(start.len()..))
}

/// Splits a line as a shell would where it only holds plain and quoted words and a comment.
fn words(line: &str) -> Result<Vec<String>> {
    let mut words = Vec::new();
    let mut word: Option<String> = None;
    let mut quote: Option<char> = None;
    for c in line.chars() {
        match (quote, c) {
            (Some(open), _) if c == open => quote = None,
            (Some(_), _) => word.get_or_insert_default().push(c),
            (None, '"' | '\'') => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            (None, '#') if word.is_none() => break,
            (None, _) if c.is_whitespace() => words.extend(word.take()),
            (None, '|' | '>' | '<' | '&' | ';' | '$' | '`' | '*') => {
                bail!("`{c}` needs a shell, and this check has none")
            }
            (None, _) => word.get_or_insert_default().push(c),
        }
    }
    if quote.is_some() {
        bail!("a quote is not closed");
    }
    words.extend(word);
    Ok(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_programs_own_commands_are_taken() {
        let page = "\
```sh
git clone somewhere   # the rest is ours
cargo run --release -- demo
inkrig align walk.bvh \\
    --curve \"my curve.svg\"
```
inkrig outside a block
```text
inkrig align YOUR.bvh
```
";
        let expected = [vec!["demo"], vec!["align", "walk.bvh", "--curve", "my curve.svg"]];
        assert_eq!(commands(page).unwrap(), expected);
    }

    #[test]
    fn what_needs_a_shell_is_refused() {
        assert!(commands("```sh\ninkrig demo | less\n```").is_err());
        assert!(words("inkrig 'demo").is_err());
        assert_eq!(words("a '' \"b|c\"d").unwrap(), ["a", "", "b|cd"]);
    }
}
