//! One-time tokens for other devices, and the cookies that they become.

use sha2::{Digest, Sha256};
use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Devices that are let in at once; the first to come is the first to go.
const MOST_DEVICES: usize = 16;

/// The token that is printed, and cookies that were given for earlier ones. Only their hashes are kept and compared, so that
/// the time of a comparison tells nothing.
pub(crate) struct Tokens {
    state: Mutex<State>,
    /// Called with every new token.
    announce: Box<dyn Fn(&str) + Send + Sync>,
}

#[derive(Default)]
struct State {
    token: Option<[u8; 32]>,
    cookies: VecDeque<[u8; 32]>,
}

impl Tokens {
    /// Makes the first token and announces it.
    pub(crate) fn new(announce: impl Fn(&str) + Send + Sync + 'static) -> Result<Self, String> {
        let tokens = Self { state: Mutex::default(), announce: Box::new(announce) };
        tokens.renew()?;
        Ok(tokens)
    }

    /// A cookie for the token that was printed last. It is spent then, and a new one announced.
    pub(super) fn exchange(&self, token: &str) -> Option<String> {
        let mut state = self.lock();
        if state.token != Some(hash(token)) {
            return None;
        }
        state.token = None;
        let cookie = random().ok()?;
        state.cookies.push_back(hash(&cookie));
        while state.cookies.len() > MOST_DEVICES {
            state.cookies.pop_front();
        }
        drop(state);
        let _ = self.renew();
        Some(cookie)
    }

    /// Whether a cookie was given.
    pub(super) fn is_known(&self, cookie: &str) -> bool {
        self.lock().cookies.contains(&hash(cookie))
    }

    fn renew(&self) -> Result<(), String> {
        let token = random()?;
        self.lock().token = Some(hash(&token));
        (self.announce)(&token);
        Ok(())
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl std::fmt::Debug for Tokens {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Tokens").finish_non_exhaustive()
    }
}

/// 128 bits that nobody guesses, as 32 letters.
fn random() -> Result<String, String> {
    let mut bytes = [0_u8; 16];
    getrandom::fill(&mut bytes).map_err(|error| error.to_string())?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

fn hash(text: &str) -> [u8; 32] {
    Sha256::digest(text.as_bytes()).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn a_token_is_good_once() {
        let printed = Arc::new(Mutex::new(Vec::new()));
        let seen = printed.clone();
        let tokens = Tokens::new(move |token| seen.lock().unwrap().push(token.to_string())).unwrap();
        let first = printed.lock().unwrap()[0].clone();
        assert_eq!(tokens.exchange("wrong"), None);
        let cookie = tokens.exchange(&first).unwrap();
        assert!(tokens.is_known(&cookie) && !tokens.is_known(&first) && !tokens.is_known(""));
        assert_eq!(tokens.exchange(&first), None, "it is spent");
        let second = printed.lock().unwrap()[1].clone();
        assert_ne!(first, second);
        assert!(tokens.exchange(&second).is_some() && tokens.is_known(&cookie));
    }
}
