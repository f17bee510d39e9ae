#![allow(clippy::unwrap_used)]
mod common;
use common::*;
use ramp_render::Sensor;
use ramp_robot::random::Stream;
use ramp_robot::{Camera, CameraModel};
use ramp_vision::{Lying, PartFinder};
use std::time::Instant;

#[test]
fn probe() {
    let table = Table::new();
    let mut finder = PartFinder::new(&table.kit).unwrap();
    for (camera, ideal) in [(Camera::Wrist, true), (Camera::Wrist, false), (Camera::BirdsEye, false)] {
        let model = CameraModel::nominal(camera, TIP);
        let mut renderer = table.renderer(&model);
        let mut sensor = if ideal { Sensor::ideal() } else { Sensor::new(1, "x") };
        let mut stream = Stream::new(1, "probe");
        for h in [0.15, 0.2, 0.25, 0.35, 0.5] {
            let mut errs: Vec<[f64; 2]> = Vec::new();
            let mut signed = nalgebra::Vector3::zeros();
            let mut odd = Vec::new();
            let mut px = 0.0;
            let (mut seen, mut time) = (0, 0.0);
            let mut chi = 0.0;
            for _ in 0..10 {
                let eye = [0.1 + 0.5 * stream.uniform(), 0.2 + 0.35 * stream.uniform(), h + 0.03];
                let x_wt = tip_above(
                    &model,
                    eye,
                    stream.symmetric(1.5),
                    [stream.symmetric(0.2), stream.symmetric(0.2)],
                );
                let image = table.look(&mut renderer, &mut sensor, camera, x_wt);
                let begin = Instant::now();
                let lying =
                    if std::env::var("LYING").is_ok() { Lying::at_start(&table.kit) } else { Vec::new() };
                let s = finder.find(&image, &model, &lying).unwrap();
                time += begin.elapsed().as_secs_f64();
                seen += s.detections.len();
                for p in &s.parts {
                    let truth = table.truth(&p.part);
                    let d = p.x_wp.translation.vector - truth.translation.vector;
                    let mid = p
                        .tags
                        .iter()
                        .map(|t| finder.places()[t].x_pg.translation.vector)
                        .sum::<nalgebra::Vector3<f64>>()
                        / p.tags.len() as f64;
                    let dm = (p.x_wp * nalgebra::Point3::from(mid)) - (truth * nalgebra::Point3::from(mid));
                    let a = (p.x_wp.rotation * truth.rotation.inverse()).scaled_axis();
                    let v = nalgebra::Vector6::new(-d.x, -d.y, -d.z, -a.x, -a.y, -a.z);
                    chi += (v.transpose() * p.covariance.try_inverse().unwrap() * v)[0] / 6.0;
                    errs.push([dm.norm() * 1e3, a.norm().to_degrees()]);
                    signed += dm * 1e3;
                    px += p.pixel_error;
                }
                odd.extend(s.oddities);
            }
            let n = errs.len().max(1);
            let q = |k: usize, share: f64| {
                let mut v: Vec<f64> = errs.iter().map(|e| e[k]).collect();
                v.sort_by(f64::total_cmp);
                v.get((share * n as f64) as usize).copied().unwrap_or(f64::NAN)
            };
            println!(
                "{} {ideal} h {h}: tags {seen} parts {n} pos {:.3} {:.3} max {:.3} rot {:.3} {:.3} mean {:.3} {:.3} {:.3} px {:.3} chi {:.2} time {:.1} ms odd {}",
                camera.name(),
                q(0, 0.5),
                q(0, 0.95),
                q(0, 0.9999),
                q(1, 0.5),
                q(1, 0.95),
                signed.x / n as f64,
                signed.y / n as f64,
                signed.z / n as f64,
                px / n as f64,
                chi / n as f64,
                time * 100.0,
                odd.len()
            );
            for o in odd.iter().take(3) {
                println!("    {o}");
            }
            if camera == Camera::BirdsEye {
                break;
            }
        }
    }
}
