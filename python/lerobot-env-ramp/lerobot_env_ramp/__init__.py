"""Skills and goals of RAMP as environments of LeRobot: ``lerobot-eval --env.type=ramp --env.task=fasten``.

LeRobot imports each installed package whose name begins with ``lerobot_env_``.
"""

from lerobot_env_ramp.adapter import Adapter, steps_of
from lerobot_env_ramp.config import RampEnvConfig

__all__ = ["Adapter", "RampEnvConfig", "steps_of"]
