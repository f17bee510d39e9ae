"""Environments for Gymnasium 1.1 or newer: the goals of the benchmark, and its skills alone.

They are registered as ``RAMP/Fasten-v0`` and so on when :mod:`ramp` is imported and Gymnasium is there:

>>> import gymnasium, ramp
>>> env = gymnasium.make("RAMP/Fasten-v0", goals=["easy-3"], starts=(1, 1))
>>> observation, info = env.reset(seed=1)
>>> observation["error"].shape
(6,)
>>> env.close()
"""

from ramp._register import CHAIN, IDS, problem, register

if _problem := problem():
    raise ImportError(_problem)

from ramp.gym.chain import RampChainEnv  # noqa: E402
from ramp.gym.env import RampEnv  # noqa: E402
from ramp.gym.vector import RampVectorEnv  # noqa: E402

__all__ = ["CHAIN", "IDS", "RampChainEnv", "RampEnv", "RampVectorEnv", "register"]
