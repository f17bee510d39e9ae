//! Measures and protocol: referee, results and curves (sections III-C and III-D).
