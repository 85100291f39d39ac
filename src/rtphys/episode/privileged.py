"""What no camera shows: where things are. For state-based learning, never for a benchmark."""

from rtphys.core.poses import Array
from rtphys.episode.policy_episode import PolicyEpisode
from rtphys.sim.recorder import flat


def object_poses(episode: PolicyEpisode) -> dict[str, Array]:
    """Task object -> (7,) xyz [m] + wxyz, world frame, as datasets store `object_poses`."""
    return {name: flat(thing.pose) for name, thing in episode.rollout.world.objects.items()}


def joint_positions(episode: PolicyEpisode) -> dict[str, float]:
    """Articulated task object -> position of its first joint [rad or m]; 0 if it has none."""
    return {
        name: float(thing.articulation.qpos[0]) if thing.articulation.dof else 0.0
        for name, thing in episode.rollout.world.objects.items()
        if thing.articulation is not None
    }
