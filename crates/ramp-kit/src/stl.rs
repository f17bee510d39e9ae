//! STL, the format that every slicer reads: triangles with their normals, mm.

use crate::solid::Mesh;
use std::collections::HashMap;

/// A binary STL of a surface.
///
/// The format has single precision, so corners are rounded to it first. Equal corners stay equal,
/// and a sliver whose corners coincide is left out, so the surface stays closed.
pub fn write(mesh: &Mesh, name: &str) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(84 + 50 * mesh.triangles.len());
    // The header must not begin with "solid", the first word of the text format.
    let mut header = format!("binary STL, millimetres: {name}").into_bytes();
    header.resize(80, b' ');
    bytes.extend(header);
    let points: Vec<[f32; 3]> = mesh.points.iter().map(|point| point.map(single)).collect();
    let triangles: Vec<[[f32; 3]; 3]> = mesh
        .triangles
        .iter()
        .map(|triangle| triangle.map(|index| points[index as usize]))
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .collect();
    bytes.extend(u32::try_from(triangles.len()).unwrap_or(u32::MAX).to_le_bytes());
    for corners in triangles {
        let [a, b, c] = corners.map(|corner| nalgebra::Vector3::from(corner.map(f64::from)));
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
        for value in [normal.x, normal.y, normal.z] {
            bytes.extend(single(value).to_le_bytes());
        }
        bytes.extend(corners.as_flattened().iter().flat_map(|value| value.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

/// Rounded to single precision, without minus zero, so that equal numbers have equal bytes.
#[allow(clippy::cast_possible_truncation)]
fn single(value: f64) -> f32 {
    value as f32 + 0.0
}

/// The file is not binary STL.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("this is not a binary STL file: found {found} bytes, expected {expected}")]
pub struct StlError {
    /// The length of the file.
    pub found: usize,
    /// The length that follows from its count of triangles.
    pub expected: usize,
}

/// Reads a binary STL back; corners with equal coordinates are merged.
///
/// # Errors
/// A file whose length does not match its count of triangles.
pub fn read(bytes: &[u8]) -> Result<Mesh, StlError> {
    let short = StlError { found: bytes.len(), expected: 84 };
    let count =
        bytes.get(80..84).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes).ok_or(short)?;
    let expected = 84 + 50 * count as usize;
    if bytes.len() != expected {
        return Err(StlError { found: bytes.len(), expected });
    }
    let mut mesh = Mesh::default();
    let mut known: HashMap<[u8; 12], u32> = HashMap::new();
    for record in bytes[84..].chunks_exact(50) {
        let mut triangle = [0; 3];
        for (corner, index) in record[12..48].chunks_exact(12).zip(&mut triangle) {
            let key: [u8; 12] = corner.try_into().unwrap_or_default();
            *index = *known.entry(key).or_insert_with(|| {
                let number = |at: usize| f32::from_le_bytes([key[at], key[at + 1], key[at + 2], key[at + 3]]);
                mesh.points.push([number(0), number(4), number(8)].map(f64::from));
                u32::try_from(mesh.points.len() - 1).unwrap_or(u32::MAX)
            });
        }
        mesh.triangles.push(triangle);
    }
    Ok(mesh)
}
