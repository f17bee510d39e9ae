"""Environments for Gymnasium 1.x: the goals of the benchmark, and its skills alone.

They are registered as ``RAMP/Fasten-v0`` and so on when :mod:`ramp` is imported and Gymnasium is there:

>>> import gymnasium, ramp
>>> env = gymnasium.make("RAMP/Fasten-v0", goals=["easy-3"], starts=(1, 1))
>>> observation, info = env.reset(seed=1)
>>> observation["error"].shape
(6,)
>>> env.close()
"""

from ramp.gym.chain import RampChainEnv
from ramp.gym.env import RampEnv
from ramp.gym.register import CHAIN, IDS, register
from ramp.gym.vector import RampVectorEnv

__all__ = ["CHAIN", "IDS", "RampChainEnv", "RampEnv", "RampVectorEnv", "register"]
