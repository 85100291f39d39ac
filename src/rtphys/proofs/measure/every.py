"""All experiments on one built world, in an order in which none spoils another's."""

from collections.abc import Collection, Mapping

from rtphys.core.poses import Pose
from rtphys.proofs.measure.articulated import weigh_articulated
from rtphys.proofs.measure.camera import locate
from rtphys.proofs.measure.finding import TOLERANCES, Finding, Unmeasured
from rtphys.proofs.measure.free_body import weigh_bodies
from rtphys.proofs.measure.servos import drag
from rtphys.proofs.measure.size import size_up
from rtphys.proofs.measure.specimen import Specimen, lift
from rtphys.proofs.measure.table import survey
from rtphys.proofs.measure.throw import hit_surfaces


def measure(
    specimen: Specimen, acting: Collection[str], cameras: Mapping[str, Pose]
) -> list[Finding]:
    """What experiments find of every attribute of the label; the world is used up.

    Args:
        acting: attributes that act in this episode, as its label says. Others are measured all
            the same where there is something to measure: the label may be wrong in this, too.
        cameras: other statements of where the head camera was (`locate`).
    """
    lift(specimen.world)
    found = [*size_up(specimen), *locate(specimen, cameras)]
    found += [*weigh_bodies(specimen), *weigh_articulated(specimen)]
    lift(specimen.world)  # again at rest
    found += [*survey(specimen), *hit_surfaces(specimen), *drag(specimen)]
    silent = specimen.keys - {finding.key for finding in found}
    return [*found, *(Unmeasured(key, "", _why(key, acting)) for key in sorted(silent))]


def _why(key: str, acting: Collection[str]) -> str:
    if key not in acting:
        return "acts on nothing in this episode"
    return "no experiment knows it" if key not in TOLERANCES else "nothing here has it"
