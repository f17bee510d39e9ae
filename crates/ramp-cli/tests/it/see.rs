//! `ramp see`, as a person calls it.

use assert_cmd::Command;

fn ramp() -> Command {
    Command::cargo_bin("ramp").unwrap()
}

#[test]
fn images_and_a_table_for_a_goal() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("new");
    let output = ramp().args(["see", "easy-3", "--seed", "2", "-o"]).arg(&path).assert().success();
    let text = String::from_utf8(output.get_output().stdout.clone()).unwrap();
    assert!(text.contains("birds-eye: ") && text.contains("\np15 "), "{text}");
    for name in ["wrist.png", "wrist-found.png", "birds-eye.png", "birds-eye-found.png"] {
        let bytes = std::fs::read(path.join(name)).unwrap();
        assert!(bytes.starts_with(b"\x89PNG"), "{name}");
    }
}

#[test]
fn a_data_set_is_the_same_again_and_can_be_judged() {
    let folder = tempfile::tempdir().unwrap();
    let make = |name: &str| {
        let path = folder.path().join(name);
        let output = ramp().args(["see", "easy-1", "--count", "10", "-o"]).arg(&path).assert().success();
        // Each of the two tables stands below its conditions, the baseline's first.
        let text = String::from_utf8(output.get_output().stdout.clone()).unwrap();
        let tables: Vec<&str> = text.split("\n\n").filter(|part| part.contains("distance m")).collect();
        assert_eq!(tables.len(), 2, "{text}");
        assert!(tables[0].starts_with("estimates-lying.json, like the baseline in an episode."), "{text}");
        assert!(tables[1].starts_with("estimates.json, each image alone. Nothing is known"), "{text}");
        path
    };
    let (first, second) = (make("first"), make("second"));
    for name in ["labels.json", "coco.json", "estimates.json", "00003.png", "00009.png"] {
        assert!(
            std::fs::read(first.join(name)).unwrap() == std::fs::read(second.join(name)).unwrap(),
            "{name}"
        );
    }
    let judge = |file: &str| ramp().args(["see", "--judge"]).arg(first.join(file)).arg(&first).assert();
    let output = judge("estimates.json").success();
    let text = String::from_utf8(output.get_output().stdout.clone()).unwrap();
    assert!(text.contains("false poses") && text.contains(": 0 of "), "{text}");
    // The errors of a bad detector are measured; a file that is not a detector's output is rejected.
    let text = std::fs::read_to_string(first.join("estimates.json")).unwrap();
    let mut bad: serde_json::Value = serde_json::from_str(&text).unwrap();
    bad[0]["x_cp"]["position"][0] = 3.0.into();
    std::fs::write(first.join("bad.json"), bad.to_string()).unwrap();
    judge("bad.json").code(1);
    let error = judge("00003.png").code(2);
    assert!(String::from_utf8_lossy(&error.get_output().stderr).contains("00003.png"));
}

#[test]
fn a_film_with_nowhere_to_go_is_refused_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "").unwrap();
    let error =
        ramp().args(["run", "easy-1", "--video", "file/film.gif"]).current_dir(&folder).assert().code(2);
    assert!(String::from_utf8_lossy(&error.get_output().stderr).contains("is no folder"));
    assert!(!folder.path().join("results").exists());
}

/// Without tags, the drawing lies over the image, and from above every part is found to a millimetre or two.
#[test]
fn parts_without_tags_are_found_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("seen");
    let output = ramp()
        .args(["see", "easy-3", "--track", "colour", "--seed", "2", "-o"])
        .arg(&path)
        .assert()
        .success();
    let text = String::from_utf8_lossy(&output.get_output().stdout).to_string();
    let above = text.split("birds-eye").nth(1).unwrap();
    let parts: Vec<Vec<&str>> = above
        .lines()
        .skip(2)
        .map(|line| line.split_whitespace().collect())
        .filter(|row: &Vec<_>| row.len() == 8)
        .collect();
    assert!(parts.len() >= 22, "{text}");
    for row in &parts {
        let off = |index: usize| row[index].parse::<f64>().unwrap();
        assert!(off(4).hypot(off(5)) < 2.5, "{row:?}");
    }
    for camera in ["wrist", "birds-eye"] {
        let image = std::fs::read(path.join(format!("{camera}.png"))).unwrap();
        let drawn = std::fs::read(path.join(format!("{camera}-found.png"))).unwrap();
        assert_ne!(image, drawn);
    }
}

/// With depth, the images of both cameras have theirs beside them: 16 bits, and the same parts are found.
#[test]
fn depth_is_written_beside_the_images() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("seen");
    let output =
        ramp().args(["see", "easy-3", "--track", "depth", "--seed", "2", "-o"]).arg(&path).assert().success();
    assert!(String::from_utf8_lossy(&output.get_output().stdout).contains("birds-eye: 2"));
    for (camera, far) in [("wrist", 300.0..1500.0), ("birds-eye", 2400.0..2600.0)] {
        let file = std::fs::File::open(path.join(format!("{camera}-depth.png"))).unwrap();
        let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!((info.width, info.height, info.bit_depth), (1280, 800, png::BitDepth::Sixteen));
        // In the middle of the image there is table.
        let middle = 2 * (400 * 1280 + 1000);
        let depth = f64::from(u16::from_be_bytes([bytes[middle], bytes[middle + 1]])) / 10.0;
        assert!(far.contains(&depth), "{camera}: {depth} mm");
    }
}

/// Images without tags in the form of BOP: poses, lens and meshes agree with the masks, and what shows of a
/// part is within it.
#[test]
fn a_set_without_tags_is_in_the_form_of_bop() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("set");
    let see = |options: &[&str]| {
        ramp()
            .args(["see", "easy-3", "--track", "depth", "--seed", "3", "-o"])
            .arg(&path)
            .args(options)
            .assert()
    };
    see(&["--count", "1", "--no-images"]).code(2);
    let output = see(&["--count", "3"]).success();
    assert!(String::from_utf8_lossy(&output.get_output().stdout).contains("AR by MSPD"));
    let json = |name: &str| -> serde_json::Value {
        serde_json::from_slice(&std::fs::read(path.join(name)).unwrap()).unwrap()
    };
    let numbers = |value: &serde_json::Value| -> Vec<f64> {
        value.as_array().unwrap().iter().map(|it| it.as_f64().unwrap()).collect()
    };
    let mask = |kind: &str, image: usize, index: usize| -> Vec<bool> {
        let name = path.join(format!("test/000001/{kind}/{image:06}_{index:06}.png"));
        let file = std::io::BufReader::new(std::fs::File::open(name).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        bytes.iter().map(|byte| *byte > 0).collect()
    };
    let (cameras, truths, infos) = (
        json("test/000001/scene_camera.json"),
        json("test/000001/scene_gt.json"),
        json("test/000001/scene_gt_info.json"),
    );
    let mut parts = 0;
    for image in 0..3 {
        assert!(path.join(format!("test/000001/depth/{image:06}.png")).exists());
        let key = image.to_string();
        let k = numbers(&cameras[&key]["cam_K"]);
        let all = truths[&key].as_array().unwrap().iter().zip(infos[&key].as_array().unwrap());
        for (index, (truth, info)) in all.enumerate() {
            let (whole, visible) = (mask("mask", image, index), mask("mask_visib", image, index));
            assert!(visible.iter().zip(&whole).all(|(visible, whole)| *whole || !visible));
            assert_eq!(
                visible.iter().filter(|it| **it).count() as u64,
                info["px_count_visib"].as_u64().unwrap()
            );
            let shown = || visible.iter().enumerate().filter(|(_, shows)| **shows).map(|(at, _)| at);
            let ends = |place: fn(usize) -> usize| [shown().map(place).min(), shown().map(place).max()];
            if let ([Some(left), Some(right)], [Some(top), Some(bottom)]) =
                (ends(|at| at % 1280), ends(|at| at / 1280))
            {
                let box_of_mask = serde_json::json!([left, top, right - left, bottom - top]);
                assert_eq!(info["bbox_visib"], box_of_mask, "image {image}, part {index}");
            }
            let (r, t) = (numbers(&truth["cam_R_m2c"]), numbers(&truth["cam_t_m2c"]));
            let mesh = path.join(format!("models/obj_{:06}.ply", truth["obj_id"].as_u64().unwrap()));
            let text = std::fs::read_to_string(mesh).unwrap();
            let corners =
                text.split("end_header\n").nth(1).unwrap().lines().filter(|line| !line.starts_with("3 "));
            let (mut inside, mut count) = (0, 0);
            for line in corners {
                let p: Vec<f64> = line.split(' ').take(3).map(|it| it.parse().unwrap()).collect();
                let at = |row: usize| (0..3).map(|axis| r[3 * row + axis] * p[axis]).sum::<f64>() + t[row];
                let pixel = [k[0] * at(0) / at(2) + k[2], k[4] * at(1) / at(2) + k[5]].map(f64::round);
                if at(2) > 0.0 && (3.0..1277.0).contains(&pixel[0]) && (3.0..797.0).contains(&pixel[1]) {
                    let near = |dx: isize, dy: isize| {
                        let place = (pixel[1] as isize + dy) * 1280 + pixel[0] as isize + dx;
                        whole[place as usize]
                    };
                    count += 1;
                    inside += usize::from((-2..=2).any(|dy| (-2..=2).any(|dx| near(dx, dy))));
                }
            }
            assert!(
                inside as f64 >= 0.98 * f64::from(count),
                "image {image}, part {index}: {inside} of {count}"
            );
            parts += 1;
        }
    }
    assert!(parts > 5, "{parts}");
    // The pegs are one object, which a quarter turn leaves as it is.
    let models = json("models/models_info.json");
    let peg = models.as_object().unwrap().values().find(|it| it["parts"][0] == "p1").unwrap();
    assert_eq!(peg["symmetries_discrete"].as_array().unwrap().len(), 3);
    let poses = std::fs::read_to_string(path.join("baseline_set-test.csv")).unwrap();
    assert!(poses.lines().count() > 5 && poses.lines().skip(1).all(|line| line.split(',').count() == 7));
}
