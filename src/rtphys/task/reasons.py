"""Why an attempt is rejected: a closed list, so that rejections can be counted and compared."""

REASONS: dict[str, str] = {
    "invalid_physics": "no real object could have this draw",
    "layout": "no layout of this seed satisfies the task's spacing rules",
    "unsettled": "objects did not come to rest before the episode (tilt, low friction)",
    "unreachable": "no inverse-kinematics solution for any allowed pose",
    "no_path": "no collision-free path between two reachable poses",
    "retime_failed": "the path could not be time-parameterised",
    "ungraspable": "no contact point fits the gripper",
    "grasp_missed": "the fingers closed on nothing",
    "slipped": "the object left the hand",
    "too_slow": "the motion cannot finish within the task's step limit",
    "stalled": "an articulated part did not follow the hand",
    "failed_check": "the script ran to its end and the success condition did not hold",
    "not_held": "success held for an instant, but not 0.5 s later",
    "recovered": "a load was lost and would have to be taken again, which was not allowed",
    "disturbed": "another object was knocked over or off the table",
    "untwinned": "it was accepted, its twin under another protocol was not",
    "worker_crash": "the worker process died twice on this attempt",
    "worker_hang": "the worker process exceeded its time limit twice on this attempt",
}

PHYSICS_REASONS = frozenset(
    {"invalid_physics", "unsettled", "slipped", "too_slow", "stalled", "not_held", "grasp_missed"}
    | {"recovered"}
)
"""Reasons that physics explains; the rest point at planning, geometry or the machine."""
