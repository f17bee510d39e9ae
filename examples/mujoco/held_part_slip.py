"""A held part slips in a hand that turns, however hard it is held: a minimal scene for MuJoCo alone.

MuJoCo's rows of friction ask for J a = -b (J v), with the acceleration a, the velocity v and b = 2 /
timeconst. They leave out the term (dJ/dt) v. On a circle with the radius R that is v² / R for the hand, and
nothing for a free part. So the part slips outward at the speed (v² / R) / b, whatever the force and the
friction. With the step h, it slips by

    (1/b - h/2) ∫ v² / R dt     with integrators that are explicit in these rows, as here
    (1/b + h/2) ∫ v² / R dt     with the integrator of the benchmark's twin

    pip install mujoco
    python held_part_slip.py
"""

from __future__ import annotations

import math
import pathlib

import mujoco
import numpy as np

RADIUS = 0.6
"""Distance of the hand from its joint, m."""
ANGLE = 1.5
"""How far it turns, rad."""
CLOSING = 0.3
"""How long the fingers close before it turns, s."""


def slip(speed: float, force: float, timeconst: float) -> tuple[float, float]:
    """Slip of a motion at ``speed`` (m/s) at most, in a grasp of ``force`` (N), and by the formula, m."""
    model = mujoco.MjModel.from_xml_path(str(pathlib.Path(__file__).with_suffix(".xml")))
    model.geom_solref[:, 0] = timeconst
    data = mujoco.MjData(model)
    step = model.opt.timestep
    duration = 1.875 * ANGLE * RADIUS / speed
    start, predicted = 0.0, 0.0
    for number in range(round((CLOSING + duration + 0.1) / step)):
        # A polynomial that begins and ends at rest, fastest in the middle.
        part = min(max((number * step - CLOSING) / duration, 0.0), 1.0)
        data.ctrl[:] = ANGLE * part**3 * (10 - part * (15 - 6 * part)), force, force
        mujoco.mj_step(model, data)
        turn = data.joint("turn").qpos[0]
        along = float(data.body("part").xpos[:2] @ np.array([math.cos(turn), math.sin(turn)]))
        if number * step < CLOSING:
            start = along
        else:
            predicted += (timeconst / 2 - step / 2) * RADIUS * data.joint("turn").qvel[0] ** 2 * step
    return along - start, predicted


def main() -> None:
    """Prints slip and formula for several speeds, forces and time constants."""
    print(f"MuJoCo {mujoco.__version__}")
    print("speed m/s  force N  timeconst s  slip mm  formula mm")
    for speed, force, timeconst in [
        (0.5, 60.0, 0.004),
        (1.0, 60.0, 0.004),
        (2.0, 60.0, 0.004),
        (1.0, 20.0, 0.004),
        (1.0, 200.0, 0.004),
        (1.0, 60.0, 0.0025),
    ]:
        slipped, predicted = slip(speed, force, timeconst)
        print(f"{speed:9}  {force:7}  {timeconst:11}  {slipped * 1e3:7.3f}  {predicted * 1e3:10.3f}")


if __name__ == "__main__":
    main()
