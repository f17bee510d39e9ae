//! The AprilTags of the family tag25h9, by which cameras find the parts.

/// Cells along an edge of a tag, its white ring included.
pub const CELLS: usize = 9;
/// Cells along the black edge, which is what detectors call the tag's size.
pub const BLACK_CELLS: usize = 7;
/// Length of the black edge of a part's tag, m.
pub const BLACK_EDGE: f64 = 19.0e-3;
/// Edge of the sticker that it is printed on, m.
pub const STICKER: f64 = 25.0e-3;
/// How many tags there are: ids 0 to 34.
pub const COUNT: u32 = 35;

/// The code words of the family, as its authors publish them: 25 bits each, the first one highest.
const CODES: [u32; COUNT as usize] = [
    0x156f1f4, 0x1f28cd5, 0x16ce32c, 0x1ea379c, 0x1390f89, 0x034fad0, 0x07dcdb5, 0x119ba95, 0x1ae9daa,
    0x0df02aa, 0x082fc15, 0x0465123, 0x0ceee98, 0x1f17260, 0x14429cd, 0x17248a8, 0x16ad452, 0x09670ad,
    0x16f65b2, 0x0b8322b, 0x05d715b, 0x1a1c7e7, 0x0d7890d, 0x1813522, 0x1c9c611, 0x099e4a4, 0x0855234,
    0x17b81c0, 0x0c294bb, 0x089fae3, 0x044df5f, 0x1360159, 0x0ec31e8, 0x1bcc0f6, 0x0a64f8d,
];

/// The cells of a tag, row by row from the top, `true` where it is black; `None` for an id that the family does not
/// have.
///
/// ```
/// let cells = ramp_kit::tags::cells(7).unwrap();
/// assert!(cells[0].iter().all(|black| !black) && cells[1][1..8].iter().all(|black| *black));
/// assert!(ramp_kit::tags::cells(35).is_none());
/// ```
pub fn cells(id: u32) -> Option<[[bool; CELLS]; CELLS]> {
    let code = *CODES.get(id as usize)?;
    let mut cells = [[false; CELLS]; CELLS];
    for row in &mut cells[1..=BLACK_CELLS] {
        row[1..=BLACK_CELLS].fill(true);
    }
    let mut bits = (0..25).rev().map(|bit| code >> bit & 1 == 1);
    // Six cells of a quarter, four times around the middle, then the middle itself.
    let quarter: [[usize; 2]; 6] = [[1, 1], [2, 1], [3, 1], [4, 1], [2, 2], [3, 2]];
    for turn in 0..4 {
        for cell in quarter {
            let [x, y] = (0..turn).fold(cell, |[x, y], _| [6 - y, x]);
            cells[y + 1][x + 1] = !bits.next().unwrap_or_default();
        }
    }
    cells[4][4] = !bits.next().unwrap_or_default();
    Some(cells)
}
