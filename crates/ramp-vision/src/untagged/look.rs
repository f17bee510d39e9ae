//! One image: the believed scene is drawn, each part is fitted to it, and what the image supports is found.

use nalgebra::{Point3, SMatrix, Translation3, UnitQuaternion, Vector3};
use ramp_robot::{Camera, CameraModel, Image, Pose};

use super::acceptance::{LEAST_STEPS, SMALL, Work, accept, apart};
use super::canvas::{Canvas, Lens};
use super::contours::{Contour, Step, contours};
use super::depths::Depths;
use super::marks::{Mark, marks};
use super::pose::{Place, settle, supports};
use super::profile::Photograph;
use super::scene::{Believed, Bodies, Found, Scene, Seen};
use super::search::Pattern;
use super::solids::Surface;
use crate::fit::Level;

/// Numbers that differ between a camera that is near and one that is far.
struct Reach {
    /// Squares of the image of which each gives one step, pixels.
    cell: usize,
    /// Largest number of steps of a part.
    steps: usize,
    /// Least and largest window of the first round, pixels.
    window: [f64; 2],
    /// Standard deviation of a part's place up to which it is looked for, m.
    known: f64,
    /// That from which starts are searched for, m.
    vague: f64,
    /// A part whose steps moved by less than this is not measured again, pixels.
    still: f64,
    /// A part whose steps moved by more than this since it was drawn is drawn again, pixels.
    redraw: f64,
}

const FROM_NEAR: Reach =
    Reach { cell: 5, steps: 300, window: [8.0, 70.0], known: 9.0e-3, vague: 6.0e-3, still: 0.7, redraw: 6.0 };
const FROM_FAR: Reach = Reach {
    cell: 2,
    steps: 160,
    window: [3.0, 16.0],
    known: 40.0e-3,
    vague: 3.5e-3,
    still: 0.2,
    redraw: 0.2,
};
/// Standard deviations within which a part is looked for.
const SIGMAS: f64 = 3.0;
/// Windows of the rounds after the first, pixels.
const LATER: [f64; 2] = [5.0, 3.0];
/// Least window of a part in the hand, which may have slipped, m.
const SLIP: f64 = 3.0e-3;
/// A window of which all is looked at pixel by pixel.
const WIDE: f64 = 12.0;
/// Least number of drawn steps that can show that a part is not there, and the share of them that agrees
/// where it is not.
const MANY_STEPS: usize = 60;
const REFUTED: f64 = 0.35;
/// Nothing nearer than this is measured, m.
const LEAST_DISTANCE: f64 = 0.01;
/// Steps of a search, pixels: coarse, then fine.
const SEARCH: [f64; 2] = [2.0, 0.7];
/// Least support of the best start.
const LEAST_SUPPORT: f64 = 0.3;

/// One image, and what is believed to be in it.
pub struct Look<'a> {
    /// What can be drawn.
    pub bodies: &'a Bodies,
    /// The image.
    pub photograph: Photograph<'a>,
    /// Its camera.
    pub camera: &'a CameraModel,
    /// The scene as it is believed.
    pub scene: &'a Scene<'a>,
    /// The camera's pose in the world.
    pub x_wc: Pose,
    /// The image as it was taken.
    pub image: &'a Image,
    /// How far off a part may seem because the camera is not quite where its model has it, m.
    pub slack: f64,
}

impl Look<'_> {
    fn reach(&self) -> &'static Reach {
        if self.image.camera == Camera::Wrist { &FROM_NEAR } else { &FROM_FAR }
    }

    /// Finds those parts that are wanted.
    pub fn all(&self, canvas: &mut Canvas, wanted: &dyn Fn(&Believed) -> bool) -> Seen {
        let reach = self.reach();
        let x_cw = self.x_wc.inverse();
        let mut works: Vec<Option<Work>> = self
            .scene
            .parts
            .iter()
            .map(|part| {
                let looked_for = wanted(part) && self.spread(part) < reach.known;
                looked_for.then(|| Work::at(part.x_wp))
            })
            .collect();
        for round in 0..=LATER.len() {
            if works.iter().flatten().all(|work| work.done) {
                break;
            }
            let to_draw = works.iter().flatten().any(|work| !work.done && work.marks.is_none());
            let drawn = if to_draw { self.draw(canvas, &works) } else { Vec::new() };
            for (index, (part, work)) in self.scene.parts.iter().zip(&mut works).enumerate() {
                let Some(mut now) = work.take_if(|work| !work.done) else { continue };
                let mut window = LATER[round.max(1) - 1];
                if round == 0 {
                    let pixels = self.camera.focal[0] / (x_cw * now.x_wp).translation.z.max(0.1);
                    let spread = self.spread(part);
                    if spread + self.slack / SIGMAS > reach.vague {
                        let Some(x_wp) = self.search(canvas, &drawn[index], part) else { continue };
                        // To be drawn there.
                        now.x_wp = x_wp;
                        *work = Some(now);
                        continue;
                    }
                    let least = if part.held { SLIP * pixels } else { 0.0 };
                    let [low, high] = reach.window;
                    window = ((SIGMAS * spread + self.slack) * pixels).max(least).clamp(low, high);
                }
                // A wide window is looked through with larger pixels.
                let scale = (window / WIDE).max(1.0);
                if now.marks.is_none() {
                    let (contour, x_cp) = (&drawn[index], x_cw * now.x_wp);
                    let seen = (self.image, &self.photograph);
                    now.marks = Some(marks((canvas, contour), seen, &x_cp, reach.steps, scale));
                    now.depths = self.depths(canvas, contour, part, &x_cp);
                }
                if self.fit(&canvas.lens, part, &mut now, window, scale > 1.0).is_some() {
                    now.done = window <= reach.window[0] && now.moved < reach.still;
                    *work = Some(now);
                }
            }
        }
        let works = || self.scene.parts.iter().zip(&works);
        let found: Vec<Found> =
            works().filter_map(|(part, work)| accept(&self.x_wc, part, work.as_ref()?)).collect();
        let absent = works().filter(|(_, work)| work.as_ref().is_some_and(|work| work.absent));
        Seen {
            found: apart(found, self.scene.parts, &self.bodies.surfaces),
            absent: absent.map(|(part, _)| part.part.clone()).collect(),
        }
    }

    /// Standard deviation of the places of a part's ends in the worst direction, m.
    fn spread(&self, part: &Believed) -> f64 {
        let Some(surface) = self.bodies.surfaces.get(&part.part) else { return f64::INFINITY };
        let ([x, ..], radius) = surface.ball;
        let ends =
            [x - radius, x + radius].map(|x| part.x_wp.rotation * Vector3::new(f64::from(x), 0.0, 0.0));
        let variance = ends.map(|lever| {
            let mut slope = SMatrix::<f64, 3, 6>::identity();
            slope.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-lever.cross_matrix()));
            let covariance = slope * part.covariance * slope.transpose();
            covariance.symmetric_eigenvalues().max().max(0.0)
        });
        variance[0].max(variance[1]).sqrt()
    }

    /// The same image with another belief.
    pub fn of<'b>(&'b self, scene: &'b Scene<'b>) -> Look<'b> {
        let Look { bodies, camera, x_wc, image, slack, .. } = *self;
        Look { bodies, photograph: self.photograph.clone(), camera, scene, x_wc, image, slack }
    }

    /// All surfaces and their poses in the optical frame; of each part without marks its number among them;
    /// and the window around those.
    #[allow(clippy::type_complexity)] // Three lists of one use.
    fn placed(
        &self,
        canvas: &Canvas,
        works: &[Option<Work>],
    ) -> (Vec<(&Surface, Pose)>, Vec<Option<u16>>, Option<[[f64; 2]; 2]>) {
        let (bodies, scene) = (self.bodies, self.scene);
        let x_cw = self.x_wc.inverse();
        let mut drawn: Vec<(&Surface, Pose)> = Vec::new();
        let mut numbers = vec![None; scene.parts.len()];
        let mut window: Option<[[f64; 2]; 2]> = None;
        for (index, part) in scene.parts.iter().enumerate() {
            let Some(surface) = bodies.surfaces.get(&part.part) else { continue };
            let x_wp = works[index].as_ref().map_or(part.x_wp, |work| work.x_wp);
            let x_cp = x_cw * x_wp;
            if works[index].as_ref().is_some_and(|work| !work.done && work.marks.is_none()) {
                numbers[index] = Some(drawn.len() as u16);
                if let Some([[x0, x1], [y0, y1]]) = canvas.bounds(surface, &x_cp) {
                    let [[a0, a1], [b0, b1]] = window.unwrap_or([[x0, x1], [y0, y1]]);
                    window = Some([[a0.min(x0), a1.max(x1)], [b0.min(y0), b1.max(y1)]]);
                }
            } else if works[index].is_none()
                && part.covariance[(0, 0)].max(part.covariance[(1, 1)]).sqrt() > self.reach().known
            {
                // It may be anywhere: it hides nothing for sure.
                continue;
            }
            drawn.push((surface, x_cp));
        }
        let mut others: Vec<(&str, Pose)> =
            scene.holders.iter().map(|(name, x)| (name.as_str(), *x)).collect();
        let x_wh = self.image.x_wt * Translation3::new(0.0, 0.0, -bodies.tip);
        let over = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI);
        let (half, along) = (scene.width / 2.0, bodies.finger);
        others.push(("hand", x_wh));
        others.push(("finger1", x_wh * Translation3::new(0.0, half, along)));
        others.push(("finger2", x_wh * Pose::from_parts(Translation3::new(0.0, -half, along), over)));
        for (name, x_wb) in others {
            if let Some(surface) = bodies.surfaces.get(name) {
                drawn.push((surface, x_cw * x_wb));
            }
        }
        (drawn, numbers, window)
    }

    /// Draws surfaces in a window.
    fn paint(&self, canvas: &mut Canvas, drawn: &[(&Surface, Pose)], window: [[usize; 2]; 2]) {
        let x_cw = self.x_wc.inverse();
        canvas.begin(window);
        let up = (x_cw.rotation * Vector3::z()).map(|value| value as f32).into();
        for (body, (surface, x_cb)) in drawn.iter().enumerate() {
            canvas.draw(surface, x_cb, body as u16, up);
        }
    }

    /// Draws everything that is believed to be in the image.
    pub fn draw_all(&self, canvas: &mut Canvas) {
        let [w, h] = canvas.lens.size;
        let works: Vec<Option<Work>> = self.scene.parts.iter().map(|_| None).collect();
        let (drawn, ..) = self.placed(canvas, &works);
        self.paint(canvas, &drawn, [[0, w], [0, h]]);
    }

    /// Draws everything, as far as it is near a part without marks, and gives the contours of those.
    fn draw(&self, canvas: &mut Canvas, works: &[Option<Work>]) -> Vec<Contour> {
        let (drawn, numbers, window) = self.placed(canvas, works);
        const MARGIN: f64 = 24.0;
        let window = window.unwrap_or([[0.0; 2]; 2]).map(|[from, to]| {
            [(from - MARGIN).max(0.0).floor() as usize, (to + MARGIN).max(0.0).ceil() as usize]
        });
        self.paint(canvas, &drawn, window);
        let ground = self.ground(&canvas.lens);
        let mut part_of = vec![None; drawn.len()];
        for (index, number) in numbers.iter().enumerate() {
            if let Some(number) = number {
                part_of[usize::from(*number)] = Some(index);
            }
        }
        let of = |body: u16| part_of.get(usize::from(body)).copied().flatten();
        contours(canvas, &of, self.scene.parts.len(), self.reach().cell, &ground)
    }

    /// Which of [`GROUNDS`](super::contours::GROUNDS) is at a pixel of a drawing where no body shows.
    pub fn ground(&self, lens: &Lens) -> impl Fn([f64; 2]) -> usize {
        let lens = lens.clone();
        let (corner, size) = (self.bodies.sheet.corner, self.bodies.sheet.size);
        let turn = *self.x_wc.rotation.to_rotation_matrix().matrix();
        let eye = self.x_wc.translation.vector;
        move |pixel: [f64; 2]| {
            let [x, y] = lens.direction(pixel);
            let [dx, dy, dz] = [0, 1, 2].map(|row| turn[(row, 0)] * x + turn[(row, 1)] * y + turn[(row, 2)]);
            let far = -eye.z / dz;
            let (x, y) = (eye.x + dx * far - corner[0], corner[1] - eye.y - dy * far);
            let on_sheet = dz < 0.0 && (0.0..size[0]).contains(&x) && (0.0..size[1]).contains(&y);
            usize::from(!on_sheet)
        }
    }

    /// The knowledge of a part's height and tilt, as the fit takes it.
    fn level(&self, part: &Believed) -> Option<Level> {
        let lying = part.lying.as_ref().filter(|_| !part.held)?;
        Some(Level {
            r_wc: self.x_wc.rotation.to_rotation_matrix(),
            eye: self.x_wc.translation.z,
            p_p: Point3::origin(),
            height: [lying.height, lying.sigma[0]],
            tilt: lying.sigma[1],
            flipped: lying.flipped,
        })
    }

    /// Measures the marks of a part and moves it until they agree.
    fn fit(&self, lens: &Lens, part: &Believed, work: &mut Work, window: f64, wide: bool) -> Option<()> {
        let x_cp = self.x_wc.inverse() * work.x_wp;
        let marks = work.marks.take()?;
        let measured = |mark: &Mark| {
            let p_c = x_cp * mark.p_p;
            if p_c.z < LEAST_DISTANCE {
                return None;
            }
            let (at, normal) = (lens.project(&p_c), mark.normal);
            let found = mark.distance(&self.photograph, at, window, wide)?;
            let along = normal[0] * at[0] + normal[1] * at[1] + found.off;
            Some(Place { p_p: mark.p_p, normal, along, is_line: found.is_line })
        };
        let places: Vec<Option<Place>> = marks.iter().map(measured).collect();
        work.places = places.iter().flatten().copied().collect();
        // The hand throws a shadow on what its camera sees. A step that it may hide, or lie beside, tells
        // something only where it shows. A beam has enough steps between its materials.
        let is_small = |surface: &Surface| 2.0 * f64::from(surface.ball.1) < SMALL;
        let of_one_material = self.bodies.surfaces.get(&part.part).is_some_and(is_small);
        let in_shadow = self.image.camera == Camera::Wrist && of_one_material;
        let may_hide = |mark: &Mark| in_shadow && mark.by_light;
        let counted = |tells: &dyn Fn(&Option<Place>) -> bool| {
            marks.iter().zip(&places).filter(|(mark, place)| !may_hide(mark) || tells(place)).count()
        };
        work.steps = marks.len();
        work.candidates = counted(&Option::is_some);
        // In the hand it may have moved, and what is behind it is the hand.
        work.absent = !part.held && (work.depths.show_absence() || self.refutes(work, work.places.len()));
        if work.places.len() < LEAST_STEPS {
            work.marks = Some(marks);
            return work.absent.then_some(());
        }
        let known = (self.level(part), &work.depths);
        let fitted = settle(lens, &x_cp, &work.places, (known.0.as_ref(), known.1), window)?;
        let good =
            |place: &Option<Place>| place.as_ref().is_some_and(|place| supports(lens, &fitted.x_cp, place));
        let over = || marks.iter().zip(&places).filter(|(mark, _)| mark.across);
        work.candidates = counted(&good);
        work.across = [over().count(), over().filter(|(_, place)| good(place)).count()];
        let now = |p_p: &Point3<f64>| lens.project(&(fitted.x_cp * p_p));
        let far = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let moved = |place: &Place| far(lens.project(&(x_cp * place.p_p)), now(&place.p_p));
        work.absent |= !part.held && self.refutes(work, fitted.agreeing);
        work.moved = work.places.iter().map(moved).fold(0.0, f64::max);
        work.x_wp = self.x_wc * fitted.x_cp;
        let since_drawn = marks.iter().map(|mark| far(mark.at, now(&mark.p_p))).fold(0.0, f64::max);
        work.marks = (since_drawn < self.reach().redraw).then_some(marks);
        work.fitted = Some(fitted);
        Some(())
    }

    /// Whether an image from near, in which nothing but what is drawn hides a part, has so few of its steps
    /// that it is not where it was looked for. Where there is depth, that tells it better.
    fn refutes(&self, work: &Work, agreeing: usize) -> bool {
        self.image.camera == Camera::Wrist
            && self.image.depth.is_none()
            && work.candidates >= MANY_STEPS
            && (agreeing as f64) < REFUTED * work.candidates as f64
    }

    /// The measured depths of a part that is drawn at `x_cp`.
    fn depths(&self, canvas: &Canvas, contour: &[Step], part: &Believed, x_cp: &Pose) -> Depths {
        let body = contour.first().map(|step| canvas.faces[canvas.shown[step.inside] as usize].body);
        let surface = self.bodies.surfaces.get(&part.part);
        let window = surface.and_then(|surface| canvas.bounds(surface, x_cp));
        let Some((body, window)) = body.zip(window) else { return Depths::default() };
        Depths::of(self.image, &self.photograph, canvas, (body, x_cp), window)
    }

    /// The start on the table that the image supports best.
    fn search(&self, canvas: &Canvas, contour: &[Step], part: &Believed) -> Option<Pose> {
        let x_cw = self.x_wc.inverse();
        let x_cp = x_cw * part.x_wp;
        let pattern = Pattern::new(canvas, contour, &x_cp);
        if pattern.len() < LEAST_STEPS {
            return None;
        }
        let surface = self.bodies.surfaces.get(&part.part)?;
        let ([x, y, z], radius) = surface.ball;
        let middle = Point3::new(f64::from(x), f64::from(y), f64::from(z));
        let pixel = x_cp.translation.z / self.camera.focal[0];
        // The prior of the middle: where the origin is and how the part is turned are one.
        let lever = part.x_wp.rotation * middle.coords;
        let mut slope = SMatrix::<f64, 3, 6>::identity();
        slope.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-lever.cross_matrix()));
        let covariance = slope * part.covariance * slope.transpose();
        let shift = SIGMAS * covariance[(0, 0)].max(covariance[(1, 1)]).sqrt() + self.slack;
        let turn = SIGMAS * part.covariance[(5, 5)].sqrt();
        let lever = f64::from(radius).max(0.02);
        let axes = [Vector3::x(), Vector3::y()].map(|axis| x_cw.rotation * axis);
        let mut best = (0.0, [0.0; 3]);
        for (step, range) in SEARCH
            .into_iter()
            .zip([[shift, turn], [1.5 * SEARCH[0] * pixel, 1.5 * SEARCH[0] * pixel / lever]])
        {
            let steps = [step * pixel, step * pixel / lever];
            let count = [0, 1].map(|axis| (range[axis] / steps[axis]).ceil() as i32);
            let centre: [f64; 3] = best.1;
            for k in -count[1]..=count[1] {
                let turn = centre[2] + f64::from(k) * steps[1];
                let x_wp = moved_on_table(&part.x_wp, &middle, [centre[0], centre[1], turn]);
                let turned = pattern.at(&self.photograph, &canvas.lens, &(x_cw * x_wp), axes);
                for i in -count[0]..=count[0] {
                    for j in -count[0]..=count[0] {
                        let shift = [i, j].map(|count| f64::from(count) * steps[0]);
                        let support = turned.support(&self.photograph, shift, best.0);
                        if support > best.0 {
                            best = (support, [centre[0] + shift[0], centre[1] + shift[1], turn]);
                        }
                    }
                }
            }
        }
        (best.0 > LEAST_SUPPORT).then(|| moved_on_table(&part.x_wp, &middle, best.1))
    }
}

/// A pose shifted along the table and turned about the vertical through a point of the part.
fn moved_on_table(x_wp: &Pose, middle: &Point3<f64>, [x, y, turn]: [f64; 3]) -> Pose {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
    let at = x_wp * middle;
    let rotation = turn * x_wp.rotation;
    let origin = at.coords + Vector3::new(x, y, 0.0) - rotation * middle.coords;
    Pose::from_parts(Translation3::from(origin), rotation)
}
