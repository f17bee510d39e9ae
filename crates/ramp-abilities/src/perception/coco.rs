//! The labels in COCO's form: boxes around what is seen of each part, and which pixels that is.

use std::collections::BTreeMap;

use super::labels::ViewLabel;
use super::photograph::View;

/// COCO's form of the same labels: boxes around what is seen of each part, and which pixels that is.
pub fn coco(views: &[ViewLabel], areas: &[Vec<Area>], names: &[String]) -> serde_json::Value {
    let categories: Vec<_> =
        names.iter().enumerate().map(|(id, name)| serde_json::json!({"id": id + 1, "name": name})).collect();
    let images: Vec<_> = views
        .iter()
        .enumerate()
        .map(|(id, view)| {
            serde_json::json!({"id": id + 1, "file_name": view.file, "width": view.size[0], "height": view.size[1]})
        })
        .collect();
    let mut annotations = Vec::new();
    for (image, areas) in areas.iter().enumerate() {
        for area in areas {
            annotations.push(serde_json::json!({
                "id": annotations.len() + 1,
                "image_id": image + 1,
                "category_id": area.name + 1,
                "bbox": area.around,
                "area": area.pixels,
                "iscrowd": 0,
                "segmentation": {"size": views.get(image).map(|view| [view.size[1], view.size[0]]), "counts": area.runs},
            }));
        }
    }
    serde_json::json!({"images": images, "annotations": annotations, "categories": categories})
}

/// Which pixels show a part.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    /// Index of its name.
    pub name: usize,
    /// Left, top, width and height, pixels.
    pub around: [usize; 4],
    /// How many pixels.
    pub pixels: usize,
    /// Lengths of runs of pixels that do not and do show it, down the columns, as COCO counts them.
    pub runs: Vec<usize>,
}

/// What each pixel shows, by part; `names` are bodies by index, and what is not a part is `None`.
pub fn areas(view: &View, names: &[Option<usize>]) -> Vec<Area> {
    let [width, height] = view.label.size;
    let mut areas: BTreeMap<usize, (Area, usize)> = BTreeMap::new();
    for x in 0..width {
        for y in 0..height {
            let body = usize::from(view.bodies[y * width + x]);
            let Some(name) = names.get(body).copied().flatten() else { continue };
            let at = x * height + y;
            let start = || (Area { name, around: [x, y, x, y], pixels: 0, runs: Vec::new() }, 0);
            let (area, end) = areas.entry(name).or_insert_with(start);
            let [left, top, right, low] = area.around;
            area.around = [left.min(x), top.min(y), right.max(x), low.max(y)];
            area.pixels += 1;
            match area.runs.last_mut() {
                Some(run) if *end == at => *run += 1,
                _ => area.runs.extend([at - *end, 1]),
            }
            *end = at + 1;
        }
    }
    areas
        .into_values()
        .map(|(mut area, end)| {
            if end < width * height {
                area.runs.push(width * height - end);
            }
            let [left, top, right, low] = area.around;
            area.around = [left, top, right + 1 - left, low + 1 - top];
            area
        })
        .collect()
}
