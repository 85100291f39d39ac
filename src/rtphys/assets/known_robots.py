"""What the official configs of some robots do not say; a config's own keys take precedence.

The config of another robot says it itself, under the same keys, however alike its name is.
"""

from collections.abc import Mapping

from rtphys.assets.embodiment import ALOHA_LIMITS

ALOHA: Mapping[str, object] = {
    "joint_limits": [list(pair) for pair in ALOHA_LIMITS],
    "bent_posture": [0.0, 1.2, 1.0, -0.8, 0.0, 0.0],
    "joint_weights": [1.5, 1.5, 1.25, 1.0, 0.75, 0.5],
    # The arm's real servos reach about 3 rad/s; accelerations keep finger loads near 1 g.
    "joint_velocity": [2.5, 2.5, 2.5, 3.0, 3.0, 3.0],
    "joint_acceleration": [10.0, 10.0, 10.0, 12.0, 12.0, 14.0],
    "hand": {
        "fingertip": 0.0356,
        "palm": 0.0445,
        "pad_half_width": 0.0305,
        "pad_half_thickness": 0.01,
        "finger_travel": 0.0475,
    },
}
PIPER: Mapping[str, object] = {
    # The real elbow bends one way only. RoboTwin's URDF allows both, which invites postures that
    # face away from the table.
    "joint_limits": [
        [-2.618, 2.618],
        [0.0, 3.14],
        [-2.697, 0.0],
        [-1.832, 1.832],
        [-1.22, 1.22],
        [-3.14, 3.14],
    ],
    "bent_posture": [0.0, 1.95, -1.35, 0.0, 0.95, 0.0],
    "pair_distance": 0.5,
    "hand": {
        "fingertip": 0.0356,
        "palm": 0.0455,
        "pad_half_width": 0.0305,
        "pad_half_thickness": 0.01,
    },
}
PANDA: Mapping[str, object] = {
    "joint_velocity": [2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61],  # the maker's
    "pair_distance": 0.8,
    "hand": {
        "fingertip": 0.0322,
        "palm": 0.0145,
        "pad_half_width": 0.011,
        "pad_half_thickness": 0.012,
    },
}
KNOWN = {
    "aloha-agilex": ALOHA,
    "aloha-agilex-1": ALOHA,  # as RoboTwin's first releases call it
    "franka-panda": PANDA,
    "piper": PIPER,
}
"""By the folder's name, whole."""
