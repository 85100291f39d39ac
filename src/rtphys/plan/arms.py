"""The kinematics of both arms of an embodiment, read from its URDF once in a process."""

from functools import lru_cache

from rtphys.assets.embodiment import Embodiment
from rtphys.plan.kinematics import ArmKinematics


@lru_cache(maxsize=4)
def arm_kinematics(embodiment: Embodiment) -> dict[str, ArmKinematics]:
    """Side -> kinematics, world frame.

    Raises:
        BadFile, UnknownName: the URDF does not hold the arms that the embodiment names.
    """
    return {
        limb.side: ArmKinematics.from_urdf(embodiment.urdf, limb, embodiment.base)
        for limb in embodiment.limbs
    }
