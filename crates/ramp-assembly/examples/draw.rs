//! Draws every goal of a folder: `cargo run -p ramp-assembly --features png --example draw -- data OUT`.

use std::path::PathBuf;

fn main() -> miette::Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [data, out] = arguments.as_slice() else { miette::bail!("expected the folders data and OUT") };
    let kit = ramp_kit::read_kit(&data.join("kit.xml"))?;
    let goals = data.join("goals");
    let say = |error: std::io::Error| miette::miette!("{error}");
    let mut all = Vec::new();
    for name in ramp_assembly::goal_names(&goals).map_err(say)? {
        let assembly = ramp_assembly::read_goal(&goals.join(format!("{name}.xml")), &kit)?;
        std::fs::write(out.join(format!("{name}.svg")), ramp_assembly::draw_svg(&assembly)).map_err(say)?;
        #[cfg(feature = "png")]
        std::fs::write(out.join(format!("{name}.png")), ramp_assembly::draw::draw_png(&assembly, 1200)?)
            .map_err(say)?;
        all.push(assembly);
    }
    std::fs::write(out.join("all.svg"), ramp_assembly::draw_all_svg(&all)).map_err(say)?;
    #[cfg(feature = "png")]
    std::fs::write(out.join("all.png"), ramp_assembly::draw::draw_all_png(&all, 2400)?).map_err(say)?;
    Ok(())
}
