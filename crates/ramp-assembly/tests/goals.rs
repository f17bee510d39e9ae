//! The nine goals of the benchmark.
use ramp_assembly::{read_goal, report};
use std::path::Path;

#[test]
fn print() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let kit = ramp_kit::read_kit(&data.join("kit.xml")).unwrap();
    for name in
        ["easy-1", "easy-2", "easy-3", "medium-1", "medium-2", "medium-3", "hard-1", "hard-2", "hard-3"]
    {
        match read_goal(&data.join(format!("goals/{name}.xml")), &kit) {
            Err(e) => println!("{e:#}"),
            Ok(a) => {
                println!("{name}");
                for b in &a.beams {
                    println!(
                        "  {} {:.4?} {:.4?}",
                        b.beam.name,
                        b.x_ab.translation.vector.as_slice(),
                        b.x_ab.rotation.scaled_axis().map(f64::to_degrees).as_slice()
                    );
                }
                let r = report(&a);
                println!(
                    "  {:?} {:?}",
                    r.fits.iter().map(|f| f.residual).fold(0.0, f64::max),
                    r.smallest_gap
                );
                for i in &a.insertions {
                    println!(
                        "  {} {:.3?} {:.4}",
                        a.beams[i.beam].beam.name,
                        i.direction.as_slice(),
                        i.distance
                    );
                }
            }
        }
    }
}
