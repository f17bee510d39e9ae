//! Draws a few new goals: `cargo run -p ramp-assembly --features png --example generate -- data OUT`.

use ramp_assembly::{Class, Request, generate, generate_many};
use std::path::PathBuf;

fn main() -> miette::Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [data, out] = arguments.as_slice() else { miette::bail!("expected the folders data and OUT") };
    let kit = ramp_kit::read_kit(&data.join("kit.xml"))?;
    let say = |error: std::io::Error| miette::miette!("{error}");
    let mut goals = Vec::new();
    for class in Class::ALL {
        let beams = if class == Class::Easy { 4 } else { 6 };
        let made = generate_many(&kit, Request { beams, seed: 1, class: Some(class) }, 3)?;
        goals.extend(made.into_iter().map(|made| made.assembly));
    }
    std::fs::write(out.join("nine-new.svg"), ramp_assembly::draw_all_svg(&goals)).map_err(say)?;
    #[cfg(feature = "png")]
    std::fs::write(out.join("nine-new.png"), ramp_assembly::draw::draw_all_png(&goals, 2400)?)
        .map_err(say)?;
    let frame = generate(&kit, Request { beams: 50, seed: 3, class: Some(Class::Hard) })?.assembly;
    std::fs::write(out.join("frame.svg"), ramp_assembly::draw_svg(&frame)).map_err(say)?;
    #[cfg(feature = "png")]
    std::fs::write(out.join("frame.png"), ramp_assembly::draw::draw_png(&frame, 1600)?).map_err(say)?;
    Ok(())
}
