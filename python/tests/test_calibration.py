"""`ramp calibrate` against OpenCV: the same images, other detector, lens calibration and hand-eye solver."""

import csv
import pathlib
import re
import shutil
import subprocess

import numpy as np
import pytest

tomllib = pytest.importorskip("tomllib", reason="SKIPPED: tomllib needs Python 3.11")
cv2 = pytest.importorskip("cv2", reason="SKIPPED: opencv-python-headless is not installed")
if not hasattr(cv2, "calibrateHandEye"):
    pytest.skip("SKIPPED: this OpenCV has no calibrateHandEye", allow_module_level=True)

# The program: as the repository builds it, or as it is installed.
BUILT = pathlib.Path(__file__).resolve().parents[2] / "target/release/ramp"
PROGRAM = str(BUILT) if BUILT.exists() else shutil.which("ramp")
if PROGRAM is None:
    pytest.skip("SKIPPED: the program ramp is not built", allow_module_level=True)

# The true camera, in OpenCV's pixel coordinates.
SIZE = (800, 500)
FOCAL, CENTRE = (427.0, 425.5), (405.0, 246.5)
DISTORTION = np.array([-0.07, 0.02, 4e-4, -3e-4, 0.0])
# Samples along both sides of a pixel of an image.
SAMPLES = 3
# Distance between the tags of the sheet, and edge of their black squares, which are seven cells wide, m.
PITCH, EDGE, CELLS = 36e-3, 27e-3, 7


def ramp(folder, *arguments):
    """Runs the program, and returns its exit status and all that it printed."""
    done = subprocess.run([PROGRAM, *arguments], cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def sheet(folder):
    """The cells of the tags on the exported calibration sheet, 5 x 7 of 7 x 7 cells: true where white."""
    status, text = ramp(folder, "kit", "export", "parts")
    assert status == 0, text
    svg = (folder / "parts/calibration.svg").read_text()
    size = np.array([float(it) for it in re.search(r'viewBox="0 0 (\S+) (\S+)"', svg).groups()])
    cells = np.zeros((5, 7, CELLS, CELLS), bool)
    squares = 0
    for path, fill in re.findall(r'<path d="(M[^"]*)" fill="(#[0-9a-f]{6})"', svg):
        corners = np.array(re.findall(r"[ML](\S+) ([^MLZ]+)", path), float)
        middle = (corners.max(0) + corners.min(0) - size) / 2e3
        edge = (corners.max(0) - corners.min(0)) * 1e-3
        tag = np.round(middle / PITCH + [3, 2]).astype(int)
        if fill == "#000000":
            # A black square lies where the kit says.
            assert np.allclose(edge, EDGE, atol=1e-6) and np.allclose(middle, PITCH * (tag - [3, 2]), atol=1e-6)
            squares += 1
        else:
            assert np.allclose(edge, EDGE / CELLS, atol=1e-6)
            column, row = np.floor((middle - PITCH * (tag - [3, 2])) / EDGE * CELLS + CELLS / 2).astype(int)
            cells[tag[1], tag[0], row, column] = True
    assert squares == 35
    return cells


def camera_matrix():
    return np.array([[FOCAL[0], 0, CENTRE[0]], [0, FOCAL[1], CENTRE[1]], [0, 0, 1]])


def rays_of_pixels():
    """The directions (x/z, y/z, 1) of all samples of all pixels, row by row."""
    steps = (np.arange(SAMPLES) + 0.5) / SAMPLES - 0.5
    u = (np.arange(SIZE[0])[:, None] + steps).ravel()
    v = (np.arange(SIZE[1])[:, None] + steps).ravel()
    pixels = np.stack(np.meshgrid(u, v), -1).reshape(-1, 1, 2)
    # OpenCV's usual five iterations are good to a tenth of a pixel only.
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 40, 1e-9)
    rays = cv2.undistortPointsIter(pixels, camera_matrix(), DISTORTION, None, None, criteria).reshape(-1, 2)
    return np.concatenate([rays, np.ones((len(rays), 1))], 1)


def image_of(cells, rays, rotation, translation):
    """What the camera sees of the sheet, whose frame has its origin in the middle, y up, at this pose."""
    seen = rays @ rotation
    origin = -rotation.T @ translation
    x, y = (origin[:2] - origin[2] / seen[:, 2:] * seen[:, :2]).T
    column, row = x / PITCH + 3.5, 2.5 - y / PITCH
    on_sheet = (column >= 0) & (column < 7) & (row >= 0) & (row < 5)
    # Cells from the upper left corner of the nearest tag's black square.
    across = ((column % 1 - 0.5) * PITCH / EDGE + 0.5) * CELLS
    down = ((row % 1 - 0.5) * PITCH / EDGE + 0.5) * CELLS
    in_tag = (across >= 0) & (across < CELLS) & (down >= 0) & (down < CELLS)

    def index(values, most):
        return np.clip(values, 0, most).astype(int)

    white = cells[index(row, 4), index(column, 6), index(down, CELLS - 1), index(across, CELLS - 1)]
    light = np.where(on_sheet, np.where(in_tag & ~white, 0.05, 0.8), 0.3)
    light = light.reshape(SIZE[1], SAMPLES, SIZE[0], SAMPLES).mean((1, 3))
    light = cv2.GaussianBlur(light, (0, 0), 0.6)
    return np.round(255 * light ** (1 / 2.2)).astype(np.uint8)


def looks(count):
    """Poses of the sheet in the optical frame: rotations and translations."""
    random = np.random.default_rng(4)
    for index in range(count):
        azimuth, tilt = 2.4 * index, 0.2 + 0.4 * random.random()
        out = np.array([np.sin(tilt) * np.cos(azimuth), np.sin(tilt) * np.sin(azimuth), np.cos(tilt)])
        right = np.array([-np.sin(azimuth), np.cos(azimuth), 0])
        axes = np.stack([right, np.cross(-out, right), -out], 1)
        roll = cv2.Rodrigues(np.array([0, 0, random.uniform(-1.2, 1.2)]))[0]
        rotation = (axes @ roll).T
        eye = out * random.uniform(0.2, 0.3) + np.array([random.uniform(-0.05, 0.05), random.uniform(-0.03, 0.03), 0])
        yield rotation, -rotation @ eye


def corners_by_opencv(path, reading):
    """Corners of the tags in an image by OpenCV's detector: on the sheet (m), and in the image."""
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_25h9)
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_APRILTAG
    found, ids, _ = cv2.aruco.ArucoDetector(dictionary, parameters).detectMarkers(cv2.imread(str(path), 0))
    on_sheet, in_image = [], []
    for corners, tag in zip(found, ids.ravel(), strict=True):
        middle = np.array([PITCH * (tag % 7 - 3), PITCH * (2 - tag // 7)])
        offsets = EDGE / 2 * np.array([[-1, 1], [1, 1], [1, -1], [-1, -1]])
        on_sheet += [[*(middle + offset), 0] for offset in offsets]
        # `reading` is how OpenCV turns this family's tags.
        in_image += list(np.roll(corners[0], reading, 0))
    return np.array(on_sheet, np.float32), np.array(in_image, np.float32)


def how_tags_are_turned(path):
    """By how many corners OpenCV's first corner differs from the upper left one as printed."""

    def error(reading):
        on_sheet, in_image = corners_by_opencv(path, reading)
        homography, _ = cv2.findHomography(on_sheet[:, :2], in_image)
        return np.abs(cv2.perspectiveTransform(on_sheet[:, None, :2], homography)[:, 0] - in_image).mean()

    return min(range(4), key=error)


def angle(a, b):
    return np.degrees(np.linalg.norm(cv2.Rodrigues(a.T @ b)[0]))


def matrix(w, x, y, z):
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion(rotation):
    """w, x, y, z, where the turn is less than 180°."""
    vector = cv2.Rodrigues(rotation)[0].ravel()
    half = np.linalg.norm(vector) / 2
    return [np.cos(half), *(np.sin(half) * vector / max(2 * half, 1e-12))]


def test_lens_and_hand_eye_agree_with_opencv(tmp_path):
    cells, rays = sheet(tmp_path), rays_of_pixels()
    images = tmp_path / "images"
    images.mkdir()
    # The camera in the tip frame, and the sheet in the robot's base frame.
    r_tc, t_tc = cv2.Rodrigues(np.array([0.02, -0.03, 1.6]))[0], np.array([0.052, 0.004, -0.06])
    r_wk, t_wk = cv2.Rodrigues(np.array([0.01, -0.02, 0.4]))[0], np.array([0.45, -0.1, 0.01])
    tips = []
    for index, (rotation, translation) in enumerate(looks(8)):
        cv2.imwrite(str(images / f"{index:02}.png"), image_of(cells, rays, rotation, translation))
        # Pose of the camera in the base frame, then that of the tip.
        r_wc, t_wc = r_wk @ rotation.T, t_wk - r_wk @ rotation.T @ translation
        r_wt = r_wc @ r_tc.T
        tips.append((r_wt, t_wc - r_wt @ t_tc))
    with open(images / "poses.csv", "w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["image", "x", "y", "z", "qw", "qx", "qy", "qz"])
        rows.writerows([f"{i:02}.png", *t, *quaternion(r)] for i, (r, t) in enumerate(tips))

    for command in ["lens", "hand-eye"]:
        status, text = ramp(tmp_path, "calibrate", command, "images", "-o", "cell.toml")
        assert status == 0, text
    cell = tomllib.loads((tmp_path / "cell.toml").read_text())
    lens, pose = cell["lens"]["wrist"], cell["hand-eye"]
    ours = matrix(*pose["quaternion"]), np.array(pose["position"])

    # OpenCV from the same images.
    paths = sorted(images.glob("*.png"))
    reading = how_tags_are_turned(paths[0])
    points = [corners_by_opencv(path, reading) for path in paths]
    flags = cv2.CALIB_FIX_K3
    _, k, d, r, t = cv2.calibrateCamera(
        [on for on, _ in points], [seen for _, seen in points], SIZE, None, None, flags=flags
    )
    theirs = cv2.calibrateHandEye(
        [r for r, _ in tips],
        [t for _, t in tips],
        [cv2.Rodrigues(it)[0] for it in r],
        t,
        method=cv2.CALIB_HAND_EYE_PARK,
    )

    # Against the truth. Pixels begin half a pixel earlier here.
    assert np.allclose(lens["focal"], FOCAL, atol=0.4), lens
    assert np.allclose(np.array(lens["centre"]) - 0.5, CENTRE, atol=0.6), lens
    assert angle(ours[0], r_tc) < 0.05 and np.linalg.norm(ours[1] - t_tc) < 0.3e-3, ours
    # Against OpenCV, whose corners are less exact.
    assert np.allclose(lens["focal"], [k[0, 0], k[1, 1]], atol=3), k
    assert np.allclose(np.array(lens["centre"]) - 0.5, [k[0, 2], k[1, 2]], atol=3), k
    assert np.allclose(lens["distortion"][:2], d.ravel()[:2], atol=0.02), d
    assert angle(ours[0], theirs[0]) < 0.3 and np.linalg.norm(ours[1] - theirs[1].ravel()) < 1.5e-3, theirs
