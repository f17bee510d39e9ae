//! Pixels of one kind that touch one another, from the runs of them in the rows of an image.

/// Pixels of one kind side by side in a row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    /// First column.
    pub from: usize,
    /// Column after the last.
    pub end: usize,
    /// White pixels before it in the row.
    pub white: u32,
}

/// Pixels that touch along their edges. Its hull is, in each row, all from the first to the last of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blob {
    /// First column.
    pub left: usize,
    /// Column after the last.
    pub right: usize,
    /// First row.
    pub top: usize,
    /// Row after the last.
    pub end: usize,
    /// Number of its pixels.
    pub pixels: f64,
    /// Number of white pixels in its hull.
    pub white: f64,
    /// Sums over its hull's pixels: their number, x, y, x², xy and y².
    sums: [f64; 6],
    /// Its hull in the last row so far, and the white pixels before its last run there.
    open: Run,
}

impl Blob {
    /// One run.
    fn new(row: usize, run: &Run) -> Blob {
        Blob {
            left: run.from,
            right: run.end,
            top: row,
            end: row + 1,
            pixels: (run.end - run.from) as f64,
            white: 0.0,
            sums: [0.0; 6],
            open: *run,
        }
    }

    /// Adds a run. They come row by row and from left to right.
    fn add(&mut self, row: usize, run: &Run) {
        self.pixels += (run.end - run.from) as f64;
        (self.left, self.right) = (self.left.min(run.from), self.right.max(run.end));
        if self.end == row + 1 {
            self.white += f64::from(run.white - self.open.white);
            self.open = Run { from: self.open.from, ..*run };
        } else {
            self.close();
            self.end = row + 1;
            self.open = *run;
        }
    }

    /// Adds the last row's hull to the sums.
    fn close(&mut self) {
        let Run { from, end, .. } = self.open;
        let (count, y) = ((end - from) as f64, (self.end - 1) as f64);
        let x = from as f64 + (count - 1.0) / 2.0;
        let square = x * x + (count * count - 1.0) / 12.0;
        let sums = [1.0, x, y, square, x * y, y * y];
        self.sums.iter_mut().zip(sums).for_each(|(sum, value)| *sum += count * value);
    }

    /// Middle of its hull, pixels, and the covariance of the hull's pixels: of x, of x with y, and of y.
    pub fn shape(&self) -> ([f64; 2], [f64; 3]) {
        let [_, x, y, xx, xy, yy] = self.sums.map(|sum| sum / self.area());
        // A pixel itself is one wide, and its middle lies half of one from its edge.
        let own = 1.0 / 12.0;
        ([x + 0.5, y + 0.5], [xx - x * x + own, xy - x * y, yy - y * y + own])
    }

    /// Number of pixels of its hull.
    pub fn area(&self) -> f64 {
        self.sums[0]
    }
}

/// The blobs in an image of so many rows. `fill` adds the runs of a row, from left to right.
pub(crate) fn blobs(rows: usize, mut fill: impl FnMut(usize, &mut Vec<Run>)) -> Vec<Blob> {
    let mut runs: Vec<Run> = Vec::new();
    // For each run one of its blob that comes earlier, or itself.
    let mut earlier: Vec<u32> = Vec::new();
    let mut begins = Vec::with_capacity(rows + 1);
    let mut above = 0;
    for row in 0..rows {
        let begin = runs.len();
        begins.push(begin);
        fill(row, &mut runs);
        earlier.extend(begin as u32..runs.len() as u32);
        for here in begin..runs.len() {
            while above < begin && runs[above].end <= runs[here].from {
                above += 1;
            }
            let mut other = above;
            while other < begin && runs[other].from < runs[here].end {
                join(&mut earlier, other as u32, here as u32);
                other += 1;
            }
            // The last of them may touch the next run too.
            above = other.saturating_sub(1).max(above);
        }
        above = begin;
    }
    begins.push(runs.len());
    let mut found: Vec<Blob> = Vec::new();
    // The blob of each run that is the first of its own.
    let mut numbers = vec![0; runs.len()];
    for row in 0..rows {
        for index in begins[row]..begins[row + 1] {
            let first = first(&mut earlier, index as u32) as usize;
            if first == index {
                numbers[index] = found.len();
                found.push(Blob::new(row, &runs[index]));
            } else {
                found[numbers[first]].add(row, &runs[index]);
            }
        }
    }
    found.iter_mut().for_each(Blob::close);
    found
}

/// The first run of a blob.
fn first(earlier: &mut [u32], mut run: u32) -> u32 {
    while earlier[run as usize] != run {
        let next = earlier[run as usize];
        earlier[run as usize] = earlier[next as usize];
        run = next;
    }
    run
}

/// Makes the blobs of two runs one.
fn join(earlier: &mut [u32], a: u32, b: u32) {
    let (a, b) = (first(earlier, a), first(earlier, b));
    earlier[a.max(b) as usize] = a.min(b);
}
