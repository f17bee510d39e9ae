//! Chunks of actions: the answers of a server.

use rmpv::Value;

use crate::metadata::Metadata;
use crate::wire;

/// The largest magnitude of a number of an action: no unit of an action has use for more.
const LARGEST: f64 = 1e3;
/// Above this the gripper is told to close; it opens otherwise. As openpi's example for DROID has it.
const CLOSED: f64 = 0.5;

/// One action.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Action {
    /// The arm's numbers.
    pub arm: Vec<f64>,
    /// The gripper closes.
    pub closed: bool,
}

/// The answer of a server.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Chunk {
    /// All of its actions, at least one.
    pub actions: Vec<Action>,
    /// The policy is done once they are.
    pub done: bool,
}

/// The chunk in an answer: `actions`, or nothing but the array.
///
/// # Errors
/// The mistake, for a person, with the name of its field.
pub(crate) fn read(bytes: &[u8], metadata: &Metadata) -> Result<Chunk, String> {
    let answer = wire::from_bytes(bytes).map_err(|error| format!("its answer {error}"))?;
    let named = wire::get(&answer, "actions");
    if named.is_none() && answer.is_map() && wire::get(&answer, "__ndarray__").is_none() {
        return Err("its answer has no `actions`".to_string());
    }
    let array = wire::to_array(named.unwrap_or(&answer)).map_err(|error| format!("`actions` {error}"))?;
    let width = metadata.action_space.numbers() + 1;
    let [rows, columns] = array.shape[..] else {
        return Err(format!("`actions` is of shape {:?}, and (T, {width}) was expected", array.shape));
    };
    if columns != width || rows == 0 {
        return Err(format!(
            "`actions` is of shape ({rows}, {columns}), and (T, {width}) was expected for {}",
            metadata.action_space.name()
        ));
    }
    let fits = |number: &f64| (-LARGEST..=LARGEST).contains(number);
    let bad = array.numbers.iter().position(|number| !fits(number));
    if let Some(bad) = bad {
        let [row, column] = [bad / width, bad % width];
        return Err(format!("`actions`[{row}, {column}] is {}", array.numbers[bad]));
    }
    let actions = array
        .numbers
        .chunks_exact(width)
        .map(|numbers| Action { arm: numbers[..width - 1].to_vec(), closed: numbers[width - 1] > CLOSED });
    let done = match wire::get(&answer, "done") {
        None | Some(Value::Nil) => false,
        Some(value) => value.as_bool().ok_or("`done` is not true or false")?,
    };
    Ok(Chunk { actions: actions.collect(), done })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::{map, to_bytes};

    fn rows(rows: &[[f64; 8]]) -> Value {
        Value::from(
            rows.iter()
                .map(|row| Value::from(row.iter().map(|it| Value::from(*it)).collect::<Vec<Value>>()))
                .collect::<Vec<Value>>(),
        )
    }

    #[test]
    fn the_mistakes_of_a_chunk_name_the_field() {
        let metadata = Metadata::read(&to_bytes(&map([("open_loop_horizon", 1.into())]))).unwrap();
        let read = |value: &Value| read(&to_bytes(value), &metadata);
        let mut one = [0.25; 8];
        let chunk = read(&map([("actions", rows(&[one, one])), ("done", true.into())])).unwrap();
        assert_eq!(
            chunk,
            Chunk { actions: vec![Action { arm: vec![0.25; 7], closed: false }; 2], done: true }
        );
        one[7] = 0.75;
        // RoboArena's servers answer with the array alone.
        assert!(read(&rows(&[one])).unwrap().actions[0].closed);
        one[2] = f64::NAN;
        for (value, why) in [
            (map([("actions", rows(&[[0.0; 8], one]))]), "`actions`[1, 2] is NaN"),
            (map([("actions", rows(&[]))]), "`actions` is of shape [0]"),
            (rows(&[[1e4; 8]]), "`actions`[0, 0] is 10000"),
            (map([("actions", wire::doubles(&[0.0; 8]))]), "`actions` is of shape [8]"),
            (map([("action", rows(&[[0.0; 8]]))]), "its answer has no `actions`"),
            (map([("actions", rows(&[[0.0; 8]])), ("done", 1.into())]), "`done` is not true or false"),
        ] {
            let error = read(&value).unwrap_err();
            assert!(error.contains(why), "{value}: {error}");
        }
    }
}
