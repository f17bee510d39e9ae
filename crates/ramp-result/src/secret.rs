//! Seeds that nobody knows before: an organiser's secret is mixed into every seed, so that neither agents nor worlds can
//! be worked out from the numbers 1 to 5.
//!
//! The secret is 32 random bytes. Its commitment, SHA-256 over a name of its form and these bytes, is published before;
//! it is long enough that nobody finds the secret by trying. The secret is published after, and everybody can check both
//! the commitment and the seed of each episode.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::episode::RULES;
use crate::file::hexadecimal;

/// The version of the form of both files.
pub const SCHEMA: &str = "ramp-secret-1";
/// Bytes of a secret.
pub const LENGTH: usize = 32;

/// What is published before.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Promise {
    /// [`SCHEMA`].
    pub schema: String,
    /// The rules by which agents will be judged.
    pub rules: String,
    /// SHA-256, hexadecimal.
    pub commitment: String,
}

/// What is kept back, and published after.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Kept {
    /// [`SCHEMA`].
    pub schema: String,
    /// 32 random bytes, hexadecimal.
    pub secret: String,
}

/// Why a file holds no secret, or not the promised one.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SecretError {
    /// A file of another form.
    #[error("found the form `{0}`, expected {SCHEMA}")]
    Schema(String),
    /// It is no secret.
    #[error("the secret is not {} hexadecimal digits", 2 * LENGTH)]
    Digits,
    /// Another secret than the promised one.
    #[error("this is not the secret that was promised: its commitment is another one")]
    Differs,
}

/// An organiser's secret.
#[derive(Clone, PartialEq, Eq)]
pub struct Secret([u8; LENGTH]);

impl std::fmt::Debug for Secret {
    /// Tells nothing of it.
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str("Secret(..)")
    }
}

impl Secret {
    /// From random bytes.
    pub fn new(bytes: [u8; LENGTH]) -> Secret {
        Secret(bytes)
    }

    /// From a file's content.
    ///
    /// # Errors
    /// When it is of another form, or holds no secret.
    pub fn from_kept(kept: &Kept) -> Result<Secret, SecretError> {
        same_schema(&kept.schema)?;
        let digits = kept.secret.as_bytes();
        if digits.len() != 2 * LENGTH {
            return Err(SecretError::Digits);
        }
        let mut bytes = [0; LENGTH];
        for (byte, pair) in bytes.iter_mut().zip(digits.chunks_exact(2)) {
            let digit = |it: u8| char::from(it).to_digit(16).ok_or(SecretError::Digits);
            *byte = (digit(pair[0])? << 4 | digit(pair[1])?) as u8;
        }
        Ok(Secret(bytes))
    }

    /// What is published before.
    pub fn promise(&self) -> Promise {
        Promise { schema: SCHEMA.to_string(), rules: RULES.to_string(), commitment: self.commitment() }
    }

    /// What is kept back.
    pub fn kept(&self) -> Kept {
        Kept { schema: SCHEMA.to_string(), secret: hexadecimal(&self.0) }
    }

    /// What the secret is known by.
    ///
    /// ```
    /// # use ramp_result::secret::Secret;
    /// assert_ne!(Secret::new([0; 32]).commitment(), Secret::new([1; 32]).commitment());
    /// ```
    pub fn commitment(&self) -> String {
        hexadecimal(&self.mixed_with(&[]))
    }

    /// The seed of an episode's world: from the secret, the goal, the track and the number that stands for the seed in
    /// results. Whoever does not have the secret cannot tell it, and the same number gives another world on each track.
    ///
    /// ```
    /// # use ramp_result::secret::Secret;
    /// let secret = Secret::new([7; 32]);
    /// assert_eq!(secret.seed("easy-1", "tags", 1), secret.seed("easy-1", "tags", 1));
    /// assert_ne!(secret.seed("easy-1", "tags", 1), secret.seed("easy-1", "state", 1));
    /// assert_ne!(secret.seed("easy-1", "tags", 1), Secret::new([8; 32]).seed("easy-1", "tags", 1));
    /// ```
    pub fn seed(&self, goal: &str, track: &str, number: u64) -> u64 {
        let hash = self.mixed_with(&[goal.as_bytes(), track.as_bytes(), &number.to_le_bytes()]);
        hash.first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes))
    }

    /// SHA-256 over the secret and some words. Each word has its length in front: no two lists of words are the same.
    fn mixed_with(&self, words: &[&[u8]]) -> Vec<u8> {
        let mut hash = Sha256::new();
        hash.update(SCHEMA.as_bytes());
        hash.update([0]);
        hash.update(self.0);
        for word in words {
            hash.update((word.len() as u64).to_le_bytes());
            hash.update(word);
        }
        hash.finalize().to_vec()
    }
}

/// Is this the secret that was promised?
///
/// # Errors
/// When it is not, or one of both is of another form.
pub fn verify(promised: &Promise, revealed: &Kept) -> Result<(), SecretError> {
    same_schema(&promised.schema)?;
    let commitment = Secret::from_kept(revealed)?.commitment();
    if commitment == promised.commitment.to_ascii_lowercase() { Ok(()) } else { Err(SecretError::Differs) }
}

fn same_schema(schema: &str) -> Result<(), SecretError> {
    if schema == SCHEMA { Ok(()) } else { Err(SecretError::Schema(ramp_kit::source::shorten(schema))) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_secret_is_the_promised_one_or_is_refused() {
        let secret = Secret::new(std::array::from_fn(|index| index as u8));
        let (promised, kept) = (secret.promise(), secret.kept());
        assert_eq!(Secret::from_kept(&kept).unwrap(), secret);
        assert_eq!(verify(&promised, &kept), Ok(()));
        let other = Kept { secret: kept.secret.replace("1f", "20"), ..kept.clone() };
        assert_eq!(verify(&promised, &other), Err(SecretError::Differs));
        for wrong in ["", "00", &"g".repeat(64), &"é".repeat(32)] {
            let other = Kept { secret: wrong.to_string(), ..kept.clone() };
            assert_eq!(verify(&promised, &other), Err(SecretError::Digits), "{wrong}");
        }
        let other = Kept { schema: "x".to_string(), ..kept };
        assert!(matches!(verify(&promised, &other), Err(SecretError::Schema(_))));
        assert_eq!(format!("{secret:?}"), "Secret(..)");
    }
}
