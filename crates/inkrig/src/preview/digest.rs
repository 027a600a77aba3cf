//! The page's security policy: only the script and the style that we wrote may run.

use super::encode::base64;
use sha2::{Digest, Sha256};

/// The source expression of a content security policy that allows exactly this inline text.
pub(super) fn policy_hash(text: &str) -> String {
    format!("'sha256-{}'", base64(&Sha256::digest(text)))
}
