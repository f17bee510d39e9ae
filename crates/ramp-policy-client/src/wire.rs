//! Values on the wire: MessagePack, and arrays of numbers as maps in the form of openpi's `msgpack_numpy`:
//! `__ndarray__` true, `data`, `dtype` and `shape`, with keys that are strings or bytes.

use rmpv::Value;

/// Largest depth of nested values.
const DEEPEST: usize = 16;
/// The most dimensions of an array.
const MOST_DIMENSIONS: usize = 4;

/// Reasons why bytes or values are not what they should be, to be put after the name of a field.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WireError {
    /// Not MessagePack, nested too deep, or with bytes after its end.
    #[error("is no MessagePack value: {0}")]
    NotMessagePack(String),
    /// Not an array of numbers.
    #[error("is no array of numbers: {0}")]
    NotArray(String),
}

/// An array of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Length of each dimension.
    pub shape: Vec<usize>,
    /// The numbers, the last dimension fastest.
    pub numbers: Vec<f64>,
}

/// A value as bytes.
pub fn to_bytes(value: &Value) -> Vec<u8> {
    let mut bytes = Vec::new();
    // Writing into memory cannot fail.
    let _ = rmpv::encode::write_value(&mut bytes, value);
    bytes
}

/// The value that bytes hold.
///
/// # Errors
/// If they hold none, or more than one.
pub fn from_bytes(mut bytes: &[u8]) -> Result<Value, WireError> {
    let not = |why: String| WireError::NotMessagePack(why);
    let value = rmpv::decode::read_value_with_max_depth(&mut bytes, DEEPEST)
        .map_err(|error| not(error.to_string()))?;
    if bytes.is_empty() { Ok(value) } else { Err(not(format!("{} bytes follow its end", bytes.len()))) }
}

/// The value of a map under a key, which is a string or bytes.
pub fn get<'v>(map: &'v Value, key: &str) -> Option<&'v Value> {
    map.as_map()?.iter().find(|(own, _)| text(own) == Some(key)).map(|(_, value)| value)
}

/// A text: a string, or bytes of one.
pub fn text(value: &Value) -> Option<&str> {
    match value {
        Value::Binary(bytes) => std::str::from_utf8(bytes).ok(),
        other => other.as_str(),
    }
}

/// A map with these keys.
pub fn map<'k>(entries: impl IntoIterator<Item = (&'k str, Value)>) -> Value {
    Value::Map(entries.into_iter().map(|(key, value)| (key.into(), value)).collect())
}

/// An array whose numbers are in `data`, as NumPy's `dtype` has them.
fn array(dtype: &str, shape: &[usize], data: Vec<u8>) -> Value {
    let key = |name: &str| Value::Binary(name.as_bytes().to_vec());
    Value::Map(vec![
        (key("__ndarray__"), true.into()),
        (key("data"), Value::Binary(data)),
        (key("dtype"), dtype.into()),
        (key("shape"), Value::Array(shape.iter().map(|length| (*length as u64).into()).collect())),
    ])
}

/// A row of numbers of four bytes.
pub fn floats(numbers: &[f64]) -> Value {
    let data = numbers.iter().flat_map(|number| (*number as f32).to_le_bytes()).collect();
    array("<f4", &[numbers.len()], data)
}

/// A row of numbers of eight bytes.
pub fn doubles(numbers: &[f64]) -> Value {
    let data = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    array("<f8", &[numbers.len()], data)
}

/// An image: red, green and blue of each pixel, row by row.
pub fn image(width: usize, height: usize, rgb: Vec<u8>) -> Value {
    array("|u1", &[height, width, 3], rgb)
}

/// Depths of the pixels of an image, row by row.
pub fn depth(width: usize, height: usize, depth: &[u16]) -> Value {
    array("<u2", &[height, width], depth.iter().flat_map(|depth| depth.to_le_bytes()).collect())
}

/// The array in a value: one of NumPy, or lists of numbers.
///
/// # Errors
/// If there is none. Its numbers may be not finite.
pub fn to_array(value: &Value) -> Result<Array, WireError> {
    if value.is_map() { of_numpy(value) } else { of_lists(value) }
}

fn not(why: impl Into<String>) -> WireError {
    WireError::NotArray(why.into())
}

fn of_numpy(value: &Value) -> Result<Array, WireError> {
    let field = |key: &str| get(value, key).ok_or_else(|| not(format!("it has no `{key}`")));
    let dtype = text(field("dtype")?).ok_or_else(|| not("its `dtype` is no text"))?;
    let data = field("data")?.as_slice().ok_or_else(|| not("its `data` are no bytes"))?;
    let lengths = field("shape")?.as_array().ok_or_else(|| not("its `shape` is no list"))?;
    if lengths.len() > MOST_DIMENSIONS {
        return Err(not(format!("it has {} dimensions", lengths.len())));
    }
    let length = |value: &Value| value.as_u64().and_then(|length| usize::try_from(length).ok());
    let shape: Option<Vec<usize>> = lengths.iter().map(length).collect();
    let shape = shape.ok_or_else(|| not("its `shape` has a length that is no whole number"))?;
    let numbers: Vec<f64> = match dtype {
        "<f4" => data.as_chunks::<4>().0.iter().map(|it| f64::from(f32::from_le_bytes(*it))).collect(),
        "<f8" => data.as_chunks::<8>().0.iter().map(|it| f64::from_le_bytes(*it)).collect(),
        "<i4" => data.as_chunks::<4>().0.iter().map(|it| f64::from(i32::from_le_bytes(*it))).collect(),
        "<i8" => data.as_chunks::<8>().0.iter().map(|it| i64::from_le_bytes(*it) as f64).collect(),
        other => {
            let other = ramp_kit::source::shorten(other);
            return Err(not(format!("its `dtype` is `{other}`; <f4, <f8, <i4 and <i8 are understood")));
        }
    };
    let bytes = if dtype.ends_with('4') { 4_usize } else { 8 };
    let wanted = shape.iter().try_fold(bytes, |product, length| product.checked_mul(*length));
    if wanted != Some(data.len()) {
        return Err(not(format!("its shape is {shape:?}, and it has {} bytes", data.len())));
    }
    Ok(Array { shape, numbers })
}

/// Lists of lists of numbers, all equally long.
fn of_lists(value: &Value) -> Result<Array, WireError> {
    let Some(items) = value.as_array() else {
        let number = value.as_f64().ok_or_else(|| not("a number or a list was expected"))?;
        return Ok(Array { shape: Vec::new(), numbers: vec![number] });
    };
    let mut whole = Array { shape: vec![items.len()], numbers: Vec::new() };
    for (index, item) in items.iter().enumerate() {
        let Array { shape, numbers } = of_lists(item)?;
        if index == 0 {
            whole.shape.extend(shape);
        } else if whole.shape[1..] != shape[..] {
            return Err(not("its rows are of different lengths"));
        }
        whole.numbers.extend(numbers);
    }
    Ok(whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numpy(dtype: &str, shape: &[u64], data: &[u8]) -> Value {
        map([
            ("__ndarray__", true.into()),
            ("data", Value::Binary(data.to_vec())),
            ("dtype", dtype.into()),
            ("shape", Value::Array(shape.iter().map(|it| (*it).into()).collect())),
        ])
    }

    #[test]
    fn arrays_come_back_and_keys_may_be_strings_or_bytes() {
        for value in
            [doubles(&[1.5, -2.0]), floats(&[1.5, -2.0]), Value::from(vec![Value::from(1.5), (-2).into()])]
        {
            let back = to_array(&from_bytes(&to_bytes(&value)).unwrap()).unwrap();
            assert_eq!(back, Array { shape: vec![2], numbers: vec![1.5, -2.0] });
        }
        let bytes: Vec<u8> = [1.0_f32, 2.0].iter().flat_map(|it| it.to_le_bytes()).collect();
        assert_eq!(to_array(&numpy("<f4", &[1, 2], &bytes)).unwrap().shape, [1, 2]);
    }

    #[test]
    fn what_is_no_array_says_why() {
        let huge = numpy("<f8", &[u64::MAX, u64::MAX], &[0; 8]);
        let ragged = Value::from(vec![Value::from(vec![Value::from(1)]), Value::from(Vec::<Value>::new())]);
        for (value, why) in [
            (huge, "and it has 8 bytes"),
            (numpy("<f8", &[2], &[0; 8]), "its shape is [2], and it has 8 bytes"),
            (numpy("<f8", &[1], &[0; 11]), "it has 11 bytes"),
            (numpy("|O", &[1], &[0; 8]), "its `dtype` is `|O`"),
            (numpy("<f8", &[1; 5], &[0; 8]), "5 dimensions"),
            (map([("data", Value::Nil)]), "it has no `dtype`"),
            (ragged, "different lengths"),
            (Value::Nil, "a number or a list"),
        ] {
            let error = to_array(&value).unwrap_err().to_string();
            assert!(error.contains(why), "{value}: {error}");
        }
    }

    #[test]
    fn bytes_that_are_no_value_are_refused_without_much_memory() {
        // An array of four thousand million items, lists in lists, and bytes after the end.
        for bytes in
            [&[0xdd, 0xff, 0xff, 0xff, 0xff][..], &[0x91; 4000], &[0xc6, 0xff, 0xff, 0xff, 0xff], &[1, 2]]
        {
            assert!(from_bytes(bytes).is_err());
        }
    }
}
