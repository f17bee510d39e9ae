"""A finder of one's own: the parts by their tags, with OpenCV.

    pip install -r examples/finders/requirements.txt
    ramp run easy-1 --track tags --finder examples/finders/tags_with_opencv.py

The corners of all tags of a part give its pose, in which its z axis points about where it is believed to.
The messages are those of docs/src/reference/finders.md.
"""

import json
import sys

import cv2
import numpy as np

CORNER = 0.5  # usual error of a corner, pixels
WRONG = 2.0  # corners that are off by more do not belong to the part, pixels
SMALL = 14  # tags with a shorter side are misread too often, pixels
TILTED = np.cos(np.radians(25))  # a part whose z axis is off by more is not seen as it is
SQUARE = np.array([[-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]], float)


def matrix(quat_wxyz):
    """The rotation of a quaternion."""
    w, x, y, z = quat_wxyz
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion(rotation):
    """The quaternion of a rotation."""
    vector = cv2.Rodrigues(rotation)[0].ravel()
    angle = np.linalg.norm(vector)
    if angle < 1e-12:
        return [1.0, 0.0, 0.0, 0.0]
    return [float(np.cos(angle / 2)), *(float(it) for it in np.sin(angle / 2) * vector / angle)]


def corners_on_parts(goal):
    """By tag: its part, its pose there, and its corners in the part's frame, as the detector orders them."""
    corners = {}
    for tag in goal["tags"]:
        own = tag["edge"] / 2 * SQUARE
        turn, place = matrix(tag["x_pg"]["quat_wxyz"]), np.array(tag["x_pg"]["position"])
        corners[tag["id"]] = (tag["part"], (turn, place, tag["edge"]), own @ turn.T + place)
    return corners


def starts(tag, pixels, lens):
    """Both poses of a part that one of its tags may have: a small square looks the same tilted both ways."""
    turn, place, edge = tag
    _, turns, shifts, _ = cv2.solvePnPGeneric(edge / 2 * SQUARE, pixels, *lens, flags=cv2.SOLVEPNP_IPPE_SQUARE)
    for seen, shift in zip(turns, shifts, strict=True):
        rotation = cv2.Rodrigues(seen)[0] @ turn.T
        yield cv2.Rodrigues(rotation)[0], shift - (rotation @ place).reshape(3, 1)


def pose_of(tags, lens, up):
    """The pose of a part in the optical frame by its tags, and its covariance; None if they do not agree.

    ``up`` is its z axis as it is believed to be.
    """
    points = np.concatenate([points for _, points, _ in tags])
    pixels = np.concatenate([pixels for _, _, pixels in tags])
    poses = []
    for start in starts(tags[0][0], tags[0][2], lens):
        turn, shift = cv2.solvePnPRefineLM(points, pixels, *lens, *start)
        rotation = cv2.Rodrigues(turn)[0]
        off = cv2.projectPoints(points, turn, shift, *lens)[0].reshape(-1, 2) - pixels
        if rotation[:, 2] @ up > TILTED and shift[2] > 0.02:
            poses.append((np.sqrt(np.mean(np.sum(off**2, axis=1))), rotation, shift.ravel()))
    if not poses:
        return None
    error, rotation, shift = min(poses, key=lambda pose: pose[0])
    if error > WRONG:
        return None
    # How the corners move with a small shift and turn about the part's origin.
    seen = points @ rotation.T
    rows = []
    for axis in range(6):
        step = 1e-6 * np.eye(6)[axis]
        moved = seen + np.cross(step[3:], seen) + shift + step[:3]
        still = seen + shift
        both = [cv2.projectPoints(it, np.zeros(3), np.zeros(3), *lens)[0].reshape(-1) for it in (moved, still)]
        rows.append((both[0] - both[1]) / 1e-6)
    slope = np.array(rows).T
    information = slope.T @ slope / max(CORNER, error) ** 2
    covariance = np.linalg.inv(information + 1e-2 * np.eye(6))
    return rotation, shift, (covariance + covariance.T) / 2


def find(question, pixels, corners, detector):
    """The parts in an image."""
    image = question["image"]
    (fx, fy), (cx, cy) = image["focal"], image["centre"]
    # OpenCV has the middle of the first pixel at 0.
    lens = (
        np.array([[fx, 0, cx - 0.5], [0, fy, cy - 0.5], [0, 0, 1]]),
        np.array([image["distortion"][index] for index in (0, 1, 2, 3, 4)]),
    )
    grey = cv2.cvtColor(pixels, cv2.COLOR_RGB2GRAY)
    found, numbers, _ = detector.detectMarkers(grey)
    by_part = {}
    for number, four in zip([] if numbers is None else numbers.ravel(), found, strict=True):
        sides = np.linalg.norm(np.roll(four[0], 1, 0) - four[0], axis=1)
        if int(number) in corners and sides.min() > SMALL:
            part, tag, points = corners[int(number)]
            # OpenCV has the tags of this family upside down.
            pixels_of_tag = np.roll(four.reshape(4, 2), 2, 0).astype(float)
            by_part.setdefault(part, []).append((tag, points, pixels_of_tag))
    from_world = matrix(image["x_wc"]["quat_wxyz"]).T
    parts = []
    for believed in question["parts"]:
        seen = by_part.get(believed["part"])
        if seen is None:
            continue
        up = from_world @ matrix(believed["x_wp"]["quat_wxyz"])[:, 2]
        pose = pose_of(seen, lens, up)
        if pose is None:
            continue
        rotation, position, covariance = pose
        x_cp = {"position": position.tolist(), "quat_wxyz": quaternion(rotation)}
        parts.append({"part": believed["part"], "x_cp": x_cp, "covariance": covariance.tolist()})
    return parts


def main():
    """Answers one image after another."""
    messages = sys.stdin.buffer
    corners = corners_on_parts(json.loads(messages.readline())["goal"])
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_25h9)
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    detector = cv2.aruco.ArucoDetector(dictionary, parameters)
    while line := messages.readline():
        question = json.loads(line)
        image = question["image"]
        pixels = np.frombuffer(messages.read(image["bytes"]), np.uint8)
        messages.read(image.get("depth_bytes", 0))
        parts = find(question, pixels.reshape(image["height"], image["width"], 3), corners, detector)
        print(json.dumps({"parts": parts}), flush=True)


if __name__ == "__main__":
    main()
