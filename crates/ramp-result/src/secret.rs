//! Unpredictable seeds: an organiser's secret is mixed into every seed, so that neither agents nor
//! worlds can be computed in advance from the numbers 1 to 5.
//!
//! The secret is 32 random bytes. Its commitment, SHA-256 over the name of the file's format and
//! these bytes, is published before the runs. The secret is too long to be found by search. It is
//! published after the runs; then anyone can verify both the commitment and the seed of each
//! episode.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::episode::RULES;
use crate::file::hexadecimal;

/// Version of the format of both files.
pub const SCHEMA: &str = "ramp-secret-1";
/// Bytes of a secret.
pub const LENGTH: usize = 32;

/// The file published before the runs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Promise {
    /// [`SCHEMA`].
    pub schema: String,
    /// Version of the rules by which agents will be judged.
    pub rules: String,
    /// SHA-256, hexadecimal.
    pub commitment: String,
}

/// The file kept secret, and published after the runs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Kept {
    /// [`SCHEMA`].
    pub schema: String,
    /// 32 random bytes, hexadecimal.
    pub secret: String,
}

/// Reasons why a file does not hold a secret, or not the promised one.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SecretError {
    /// A file of another format.
    #[error("found the format `{0}`, expected {SCHEMA}")]
    Schema(String),
    /// The text is not 32 bytes in hexadecimal.
    #[error("the secret is not {} hexadecimal digits", 2 * LENGTH)]
    Digits,
    /// The secret differs from the promised one.
    #[error("the secret does not match its commitment")]
    Differs,
}

/// An organiser's secret.
#[derive(Clone, PartialEq, Eq)]
pub struct Secret([u8; LENGTH]);

impl std::fmt::Debug for Secret {
    /// Prints nothing of the secret.
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str("Secret(..)")
    }
}

impl Secret {
    /// From random bytes.
    pub fn new(bytes: [u8; LENGTH]) -> Secret {
        Secret(bytes)
    }

    /// Reads a secret from a file's content.
    ///
    /// # Errors
    /// When it has another format, or holds no secret.
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

    /// The file to be published before the runs.
    pub fn promise(&self) -> Promise {
        Promise { schema: SCHEMA.to_string(), rules: RULES.to_string(), commitment: self.commitment() }
    }

    /// The file to be kept secret.
    pub fn kept(&self) -> Kept {
        Kept { schema: SCHEMA.to_string(), secret: hexadecimal(&self.0) }
    }

    /// The commitment of the secret.
    ///
    /// ```
    /// # use ramp_result::secret::Secret;
    /// assert_ne!(Secret::new([0; 32]).commitment(), Secret::new([1; 32]).commitment());
    /// ```
    pub fn commitment(&self) -> String {
        hexadecimal(&self.mixed_with(&[]))
    }

    /// The seed of an episode's world: from the secret, the goal, the track and the seed number in
    /// results. It cannot be predicted without the secret, and the same number gives another world
    /// on each track.
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

    /// SHA-256 over the secret and some words. Each word is preceded by its length, so two
    /// different lists never hash the same bytes.
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

/// Checks that this is the promised secret.
///
/// # Errors
/// When it is not, or when one of the two has another format.
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
