"""A policy server for RAMP: it holds still, or inserts a peg by a script.

    pip install -r examples/policies/requirements.txt
    python3 examples/policies/server.py insert --port 8000
    ramp run easy-1 --skill fasten=ws://127.0.0.1:8000
    ramp trials fasten-in-f --trials 10 --policy ws://127.0.0.1:8000

The dialect is that of openpi's and RoboArena's servers (docs/src/reference/policies.md). A policy of your own
is a class like the two here: `metadata` says what it sees and does, `reset` begins an episode, and `infer`
turns an observation into a chunk of actions.
"""

import argparse
import traceback

import msgpack
import numpy as np
from websockets.sync.server import serve


def pack(value):
    """Writes arrays as maps, for msgpack."""
    if isinstance(value, np.ndarray):
        return {b"__ndarray__": True, b"data": value.tobytes(), b"dtype": value.dtype.str, b"shape": value.shape}
    raise TypeError(f"a {type(value).__name__} cannot be sent")


def unpack(value):
    """Reads arrays from maps, for msgpack."""
    if b"__ndarray__" in value:
        return np.frombuffer(value[b"data"], np.dtype(value[b"dtype"])).reshape(value[b"shape"])
    return value


class Hold:
    """Holds the arm where it is: the least that a server can do."""

    metadata = {"name": "hold", "version": "1", "action_space": "joint_velocity", "time_limit": 5.0}

    def reset(self):
        """Begins an episode. Nothing to forget."""

    def infer(self, seen):
        """Eight actions of seven joint velocities and the gripper, which stays open."""
        assert seen["observation/wrist_image_left"].shape == (224, 224, 3)
        return {"actions": np.zeros((8, 8), np.float32)}


class Insert:
    """Inserts the peg in the hand: over the hole, down, and along a spiral where the peg meets no hole.

    It knows the place of the hole from the baseline's belief, which RAMP sends on request. A policy that
    learned to see would use the images in its place.
    """

    metadata = {
        "name": "insert",
        "version": "1",
        "action_space": "cartesian_velocity",
        "open_loop_horizon": 3,
        "needs_ramp_fields": True,
        "n_external_cameras": 0,
        "image_resolution": (96, 96),
        "time_limit": 15.0,
    }
    rate = 15.0  # Hz
    unit = 0.075 * rate  # m/s of the tip at velocity 1
    gain = 2.0  # 1/s
    down = 0.02  # m/s
    touch = 4.0  # N
    pitch = 0.5e-3  # m that the spiral widens in a turn
    turn = 4.0  # rad/s
    widest = 3.0e-3  # m

    def reset(self):
        """Begins an episode."""
        self.tip = None
        self.angle = 0.0

    def infer(self, seen):
        """Three equal actions towards the hole."""
        tip = seen["ramp/tip_pose"][:3]
        if self.tip is None:
            self.tip, self.rest = tip, seen["ramp/wrench"][2]
        error = seen["ramp/goal_pose"][:3] - seen["ramp/part_pose"][:3] - (tip - self.tip)
        force = abs(seen["ramp/wrench"][2] - self.rest)
        if force > self.touch and error[2] < -2.0e-3:
            self.angle += self.turn * 3 / self.rate
        radius = min(self.pitch * self.angle / (2 * np.pi), self.widest)
        error[:2] += radius * np.array([np.cos(self.angle), np.sin(self.angle)])
        velocity = np.zeros(6)
        velocity[:2] = np.clip(self.gain * error[:2], -self.down, self.down)
        if np.linalg.norm(error[:2]) < 1.5e-3 or self.angle > 0.0:
            velocity[2] = -self.down
        action = np.append(velocity / self.unit, 1.0)
        return {"actions": np.tile(action, (3, 1))}


def handler(kind):
    """Serves each connection with a policy of its own."""

    def handle(socket):
        policy = kind()
        policy.reset()
        socket.send(msgpack.packb(policy.metadata, default=pack))
        for message in socket:
            try:
                seen = msgpack.unpackb(message, object_hook=unpack)
                if seen.pop("endpoint", "infer") == "reset":
                    policy.reset()
                    socket.send("reset successful")
                else:
                    socket.send(msgpack.packb(policy.infer(seen), default=pack))
            except Exception:
                # Words in place of bytes: the client ends the episode, and the result holds the last of them.
                socket.send(traceback.format_exc())
                raise

    return handle


def main():
    """Serves until it is interrupted."""
    parser = argparse.ArgumentParser()
    parser.add_argument("policy", choices=["hold", "insert"])
    parser.add_argument("--port", type=int, default=8000)
    arguments = parser.parse_args()
    kind = {"hold": Hold, "insert": Insert}[arguments.policy]
    with serve(handler(kind), "127.0.0.1", arguments.port, compression=None, max_size=None) as server:
        print(f"{arguments.policy} on ws://127.0.0.1:{server.socket.getsockname()[1]}", flush=True)
        server.serve_forever()


if __name__ == "__main__":
    main()
