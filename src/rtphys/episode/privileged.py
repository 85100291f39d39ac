"""Poses of the objects, which no camera shows: for state-based learning, never for benchmarks."""

from rtphys.core.poses import Array
from rtphys.episode.policy_episode import PolicyEpisode
from rtphys.sim.recorder import flat


def object_poses(episode: PolicyEpisode) -> dict[str, Array]:
    """Task object -> (7,) xyz [m] + wxyz, world frame, as datasets store `object_poses`."""
    objects = episode.rollout.world.objects
    return {name: flat(scene_object.pose) for name, scene_object in objects.items()}


def joint_positions(episode: PolicyEpisode) -> dict[str, float]:
    """Articulated task object -> position of its first joint [rad or m]; 0 if it has none."""
    return {
        name: float(scene_object.articulation.qpos[0]) if scene_object.articulation.dof else 0.0
        for name, scene_object in episode.rollout.world.objects.items()
        if scene_object.articulation is not None
    }
