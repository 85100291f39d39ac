"""Viscous damping of the joints of articulated task objects."""

from rtphys.physics.attribute import Attribute, Reading
from rtphys.physics.handles import Happened, World
from rtphys.physics.values import Interval


class ObjectJointDamping(Attribute[World, float]):
    """Damping of every joint of articulated task objects; their dry friction is set to 0.

    SAPIEN gives each joint a load-dependent friction of 0.05 by default, which would be a second
    resistance without a label.
    """

    key = "object_joint_damping"
    unit = "N·m·s/rad or N·s/m"
    nominal = None
    valid = by_prop = Interval(0, 1000)
    resolution = 1e-9
    acts_on = "joints"
    tolerance = 0.05
    what = "viscous damping of articulated task objects"

    def acted(self, happened: Happened) -> bool:
        return happened.object_joints

    def apply(self, target: World, value: float) -> None:
        for joint in target.joints:
            joint.set_friction(0.0)
            joint.set_damping(value)

    def read(self, world: World) -> dict[str, Reading]:
        """Damping as `<joint>`, dry friction as `<joint>.friction`."""
        out: dict[str, Reading] = {}
        for joint in world.joints:
            out[joint.name] = joint.damping
            out[f"{joint.name}.friction"] = joint.friction
        return out

    def expected(self, world: World, value: float) -> dict[str, Reading]:
        return {p: 0.0 if p.endswith(".friction") else value for p in self.read(world)}
