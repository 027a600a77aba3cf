//! Joints by their names.

use crate::error::Problem;
use inkrig_motion::humanml::NAMES;

/// The joint of a name, in any case and with blanks for underscores.
pub(crate) fn joint_named(said: &str) -> Result<usize, Problem> {
    let plain = said.trim().to_lowercase().replace([' ', '-'], "_");
    NAMES.iter().position(|name| *name == plain).ok_or_else(|| {
        let said: String = said.chars().take(40).collect();
        let near = nearest(&plain);
        Problem::new(
            format!("there is no joint {said:?}"),
            format!("The nearest names are {}", near.join(", ")),
        )
    })
}

/// Three names that share the most pairs of letters.
fn nearest(word: &str) -> Vec<&'static str> {
    let pairs = |text: &str| -> Vec<[char; 2]> {
        let letters: Vec<char> = text.chars().take(40).collect();
        letters.windows(2).filter_map(|pair| pair.first_chunk().copied()).collect()
    };
    let own = pairs(word);
    let mut all: Vec<(usize, &str)> = NAMES
        .iter()
        .map(|name| {
            let theirs = pairs(name);
            (theirs.iter().filter(|pair| own.contains(pair)).count(), *name)
        })
        .collect();
    all.sort_by_key(|(common, _)| std::cmp::Reverse(*common));
    all.into_iter().take(3).map(|(_, name)| name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_have_names_and_near_ones_are_offered() {
        assert_eq!(joint_named(" Right Foot"), Ok(11));
        let problem = joint_named("rigth_foot").unwrap_err();
        assert!(problem.todo.contains("right_foot"), "{problem:?}");
    }
}
