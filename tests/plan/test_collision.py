"""The robot and its surroundings: what touches, what may, and that changes cost no answer."""

from dataclasses import replace

import numpy as np
import pytest
from b1_arms import BENT, LIMITS

from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.core.poses import Pose, axis_angle
from rtphys.core.seeds import stream
from rtphys.plan.collision import CollisionChecker, Obstacle, Rules
from rtphys.plan.robot_shapes import hull

ZERO = np.zeros(6)
TABLE = Obstacle("table", np.array([0.6, 0.35, 0.025]), Pose((0, 0, 0.715)))  # top at 0.74
TIP = 0.12 + 0.0356  # of the test robot's fingers, from link6 along x
CORNERS = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
CUBE = 0.02 * CORNERS
WIDE = (0.045, 0.045)  # [m] a finger of the left and right hand from closed


@pytest.fixture(scope="module")
def robot(embodiment) -> CollisionChecker:
    return CollisionChecker(embodiment)


@pytest.fixture
def checker(robot: CollisionChecker) -> CollisionChecker:
    robot.reset()
    robot.set_obstacles([TABLE])
    return robot


@pytest.fixture
def reach(right, pose_above_table):
    """q of the right arm with its tool pointing down and the fingertips at p."""

    def solve(p) -> np.ndarray:
        pose = pose_above_table(np.array([0, 0, TIP - 0.12]) + p, 2.0)
        # Its last step is a line's, which ends within 0.02 mm.
        q = right.line(right.solve_near(pose, BENT, stream(0, "test")), pose)
        assert q is not None
        return q[-1]

    return solve


def test_home_postures_are_clear(checker) -> None:
    for q in (ZERO, BENT):
        assert checker.clear(q, q)
        assert not checker.contacts(q, q)


def test_elbow_in_the_table_and_arm_in_the_tower_are_named(checker) -> None:
    q = np.array([0, 2.8, 0.5, 0, 0, 0])
    assert not checker.clear(ZERO, q)
    for arm, postures in (("fr", (ZERO, q)), ("fl", (q, ZERO))):
        assert any(pair.startswith(arm) and "table" in pair for pair in checker.contacts(*postures))
    back = np.array([2.4, 1.6, 0.6, 0, 0, 0])
    assert "fr_link4 and tower" in checker.contacts(ZERO, back)


@pytest.mark.parametrize(("gap", "clear"), [(0.0005, False), (0.0019, True), (0.004, True)])
def test_fingers_may_come_within_two_millimetres_of_the_table(checker, reach, gap, clear) -> None:
    assert checker.clear(ZERO, reach((0.2, -0.1, 0.74 + gap))) is clear


@pytest.mark.parametrize(("gap", "clear"), [(0.002, False), (0.0045, False), (0.0055, True)])
def test_other_links_keep_five_millimetres(checker, gap, clear) -> None:
    def clear_of_plate(height: float) -> bool:
        pose = Pose((0.3, -0.6, height + 0.01))
        checker.set_obstacles([Obstacle("plate", np.array([0.5, 0.5, 0.01]), pose)])
        return checker.clear(ZERO, BENT)  # elbow up

    low, high = 0.9, 1.6  # a thin plate that comes down: where it first touches
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (low, middle) if clear_of_plate(middle) else (middle, high)
    elbow = low - 0.005  # the bisection itself feels the margin of 5 mm
    assert clear_of_plate(elbow + gap) is clear


def test_arms_that_meet_are_seen(checker, arms, pose_above_table) -> None:
    p = np.array([0.0, -0.1, 0.85])
    rng = stream(0, "test")
    q_left = arms["left"].solve_near(pose_above_table(p, 0.8), BENT, rng)
    q_right = arms["right"].solve_near(pose_above_table(p, 2.2), BENT, rng)
    assert checker.clear(q_left, ZERO)
    assert checker.clear(ZERO, q_right)
    assert any("fl" in pair and "fr" in pair for pair in checker.contacts(q_left, q_right))


def test_finger_opening_matters(checker, reach) -> None:
    q = reach((0.2, -0.1, 0.80))
    side = np.array([np.cos(2.0), np.sin(2.0), 0])  # closing direction
    post = np.array([0.2, -0.1, 0.80]) + 0.055 * side
    checker.set_obstacles([Obstacle("post", np.array([0.008, 0.008, 0.02]), Pose(post))])
    assert checker.clear(ZERO, q, (0.045, 0.01))
    assert any("post" in pair for pair in checker.contacts(ZERO, q, WIDE))
    assert checker.clear(ZERO, q, (0.01, 0.01))
    assert not checker.clear(ZERO, q, (0.01, 0.045))


def test_ignoring_concerns_one_hand_and_one_body_and_ends(checker, reach) -> None:
    q = reach((0.2, -0.1, 0.75))
    asked = ZERO, q, (0.045, 0.01)
    checker.set_obstacles([TABLE, Obstacle("cube", CUBE, Pose((0.2, -0.1, 0.765)))])
    with checker.ignoring(("left", "cube"), ("right", "a mark without shape")):
        assert any("cube" in pair for pair in checker.contacts(*asked))
    with checker.ignoring(("right", "cube")):
        assert checker.clear(*asked)
    assert not checker.clear(*asked)
    checker.set_obstacles([Obstacle("cube", np.array([0.5, 0.5, 0.05]), Pose((0.3, -0.6, 1.0)))])
    with checker.ignoring(("right", "cube")):
        assert not checker.clear(ZERO, q)  # the elbow is no part of the hand


def test_only_fingers_may_touch_what_is_ignored(checker, reach) -> None:
    q = reach((0.2, -0.1, 0.80))
    between, palm = Pose((0.2, -0.1, 0.81)), Pose((0.2, -0.1, 0.80 + TIP - 0.03))
    for place, clear in ((between, True), (palm, False)):
        checker.set_obstacles([Obstacle("cube", CUBE, place)])
        with checker.ignoring(("right", "cube")):
            assert checker.clear(ZERO, q, (0.045, 0.01)) is clear


def test_links_alone_are_asked_where_fingers_and_loads_may_touch(checker, reach) -> None:
    q, post = reach((0.2, -0.1, 0.80)), np.array([0.008, 0.008, 0.02])
    checker.attach("right", "load", CUBE + np.array([TIP + 0.02, 0, 0]))
    checker.set_obstacles([Obstacle("post", post, Pose((0.2, -0.1, 0.77)))])
    assert not checker.clear(ZERO, q)
    with checker.under(Rules(links_only=True)):
        assert checker.clear(ZERO, q)  # the load and the post
        checker.set_obstacles([Obstacle("post", post, Pose((0.2, -0.1, 0.80 + TIP - 0.03)))])
        assert not checker.clear(ZERO, q)  # the palm and the post
        assert all("link6" in pair or "camera" in pair for pair in checker.contacts(ZERO, q))
    assert not checker.clear(ZERO, q)


def test_carried_body_moves_with_the_hand(checker, reach) -> None:
    low, high = reach((0.2, -0.1, 0.745)), reach((0.2, -0.1, 0.80))
    checker.set_obstacles([TABLE, Obstacle("cube", CUBE, Pose((0.2, -0.1, 0.765)))])
    checker.attach("right", "cube", CUBE + np.array([TIP - 0.01, 0, 0]))
    assert checker.clear(ZERO, high, (0.045, 0.02))
    pairs = checker.contacts(ZERO, low, (0.045, 0.02))
    assert pairs & {"cube and table", "table and cube"}
    checker.detach("right")
    assert checker.clear(ZERO, low, (0.045, 0.02))  # the old obstacle is gone too


@pytest.mark.parametrize(
    ("gap", "resting", "transfer"), [(-0.001, 1, 0), (0.003, 1, 0), (0.007, 1, 1)]
)
def test_carried_body_may_rest_but_not_graze(checker, reach, gap, resting, transfer) -> None:
    # The lower face of the cube is 2 cm past its centre, 1 cm past the tips.
    q = reach((0.2, -0.1, 0.74 + 0.01 + gap))
    checker.attach("right", "cube", CUBE + np.array([TIP - 0.01, 0, 0]))
    assert checker.clear(ZERO, q, (0.045, 0.02)) == bool(resting)
    with checker.under(Rules(carried_margin=0.005)):
        assert checker.clear(ZERO, q, (0.045, 0.02)) == bool(transfer)


def test_carried_body_may_be_handed_over(checker, reach) -> None:
    q = reach((0.2, -0.1, 0.80))
    checker.attach("right", "cube", CUBE + np.array([TIP + 0.02, 0, 0]))
    checker.set_obstacles([Obstacle("block", CUBE, Pose((0.2, -0.1, 0.77)))])
    assert not checker.clear(ZERO, q)
    with checker.ignoring(("right", "block")):
        assert checker.clear(ZERO, q)


def test_both_hands_may_carry_one_body(checker, arms, pose_above_table) -> None:
    rng = stream(0, "test")
    q, rollers = {}, {}
    bar = CUBE * [8, 0.5, 0.5] + np.array([0, -0.1, 0.82])  # 32 cm along x, in the world
    for side, x in (("left", -0.1), ("right", 0.1)):
        X_WE = pose_above_table(np.array([x, -0.1, 0.85]), np.pi / 2)
        q[side] = arms[side].solve_near(X_WE, BENT, rng)
        assert q[side] is not None
        rollers[side] = X_WE.inverse() @ bar
    checker.attach("right", "roller", rollers["right"])
    with_other_hand = checker.contacts(q["left"], q["right"], (0.01, 0.01))
    assert any(pair.startswith("fl_link") and "roller" in pair for pair in with_other_hand)
    checker.attach("left", "roller", rollers["left"])
    assert checker.clear(q["left"], q["right"], (0.01, 0.01))


def test_contacts_name_every_pair_and_reset_forgets(checker, reach) -> None:
    asked = ZERO, reach((0.2, -0.1, 0.7405)), (0.045, 0.01)
    checker.set_obstacles([TABLE, Obstacle("cube", CUBE, Pose((0.2, -0.1, 0.765)))])
    assert {pair.split(" and ")[1] for pair in checker.contacts(*asked)} == {"table", "cube"}
    checker.reset()
    assert checker.contacts(*asked) == frozenset()


def test_a_body_of_two_parts_is_two_obstacles(checker, reach) -> None:
    asked = ZERO, reach((0.2, -0.1, 0.80)), (0.045, 0.01)
    places = (-0.4, 0.2, 0.8), (0.2, -0.1, 0.80)
    checker.set_obstacles([Obstacle("block", CUBE, Pose(p)) for p in places])
    assert not checker.clear(*asked)
    with checker.ignoring(("right", "block")):
        assert checker.clear(*asked)


def test_tilted_table_is_where_it_is(checker, reach) -> None:
    q = reach((0.2, -0.25, 0.742))
    assert checker.clear(ZERO, q)
    for tilt_deg, clear in ((2, True), (-2, False)):  # about x: positive lowers the near edge
        X_tilt = Pose((0, 0, 0.74), axis_angle((1, 0, 0), np.radians(tilt_deg)))
        tilted = Obstacle("table", TABLE.vertices, X_tilt @ Pose((0, 0, -0.025)))
        checker.set_obstacles([tilted])
        assert checker.clear(ZERO, q) is clear


def test_pairs_out_of_reach_are_not_watched(checker) -> None:
    shapes = 1 + 2 * 9  # tower; base and eight links an arm
    checker.set_obstacles([])
    checker.clear(ZERO, ZERO)
    assert checker._model.pairs < shapes * (shapes - 1) / 2


def test_mesh_collision_is_its_hull(embodiment, tmp_path) -> None:
    corners = "\n".join(f"v {x} {y} {z}" for x, y, z in CUBE * 50)  # 2 m wide, then scaled down
    faces = "f 1 2 4\nf 1 4 3\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 4 8\nf 3 8 7"
    (tmp_path / "cube.obj").write_text(f"{corners}\n{faces}\n", encoding="utf-8")
    text = embodiment.urdf.read_text(encoding="utf-8")
    primitive = '<box size="0.1 0.2 0.9"/>'
    assert primitive in text
    mesh = '<mesh filename="cube.obj" scale="0.05 0.1 0.45"/>'
    (tmp_path / "mesh.urdf").write_text(text.replace(primitive, mesh), encoding="utf-8")
    with_mesh = CollisionChecker(replace(embodiment, urdf=tmp_path / "mesh.urdf"))
    with_box = CollisionChecker(embodiment)
    seen: set[str] = set()
    for q in np.random.default_rng(1).uniform(LIMITS[:, 0], LIMITS[:, 1], (300, 2, 6)):
        pairs = with_box.contacts(*q)
        assert with_mesh.contacts(*q) == pairs
        seen |= pairs
    assert any("tower" in pair for pair in seen)


def test_flat_bodies_and_unreadable_robots_are_refused(checker, embodiment, tmp_path) -> None:
    with pytest.raises(BadValue, match="volume"):
        checker.attach("left", "sheet", CUBE * [1, 1, 0])
    with pytest.raises(BadValue, match="volume"):
        hull(CUBE[:3])
    with pytest.raises(UnknownName, match="fx_joint1"):
        joints = ("fx_joint1", *embodiment.left.joints[1:])
        CollisionChecker(replace(embodiment, left=replace(embodiment.left, joints=joints)))
    with pytest.raises(BadFile):
        CollisionChecker(replace(embodiment, urdf=tmp_path / "none.urdf"))


IN_HAND = CUBE + np.array([0.15, 0, 0])  # [m] link6 frame
NAMES = ("a", "b", "c")


class State:
    """What a checker should know, and a random walk through it."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.places = {name: self._place() for name in NAMES}
        self.shapes = {name: np.full(3, 0.03) for name in NAMES}
        self.load = IN_HAND
        self.ignored: set[tuple[str, str]] = set()
        self.carried: str | None = None

    def _place(self) -> Pose:
        return Pose(self.rng.uniform([-0.4, -0.3, 0.75], [0.4, 0.2, 1.0]))

    def change(self, checker: CollisionChecker) -> None:
        """One change, told to the checker as the expert would."""
        name = str(self.rng.choice(NAMES))
        match self.rng.integers(4):
            case 0:
                self.places[name] = self._place()
                checker.set_obstacles(self.obstacles())
            case 1:
                self.ignored ^= {("right", name)}
            case 2:
                checker.detach("left")
                self.carried = None if self.carried else name
                checker.set_obstacles(self.obstacles())
                if self.carried:
                    self.load = IN_HAND * self.rng.uniform(0.5, 2)
                    checker.attach("left", name, self.load)
            case 3:  # as from one episode to the next: another size, now and then another kind
                half = self.rng.uniform(0.01, 0.1, 3)
                self.shapes[name] = half if self.rng.random() < 0.6 else half * CORNERS
                checker.set_obstacles(self.obstacles())

    def obstacles(self) -> list[Obstacle]:
        """Everything that is not carried."""
        free = [n for n in NAMES if n != self.carried]
        return [TABLE, *(Obstacle(n, self.shapes[n], self.places[n]) for n in free)]

    def tell(self, checker: CollisionChecker) -> None:
        """All at once, to a checker that knows nothing."""
        checker.reset()
        checker._models.clear()
        checker.set_obstacles(self.obstacles())
        if self.carried:
            checker.attach("left", self.carried, self.load)


def test_changes_leave_no_trace_and_the_broad_phase_misses_no_pair(embodiment) -> None:
    changed, fresh = CollisionChecker(embodiment), CollisionChecker(embodiment)
    state, touched = State(0), 0
    changed.set_obstacles(state.obstacles())
    for _ in range(60):
        state.change(changed)
        state.tell(fresh)
        with changed.ignoring(*state.ignored), fresh.ignoring(*state.ignored):
            for q in state.rng.uniform(LIMITS[:, 0], LIMITS[:, 1], (12, 2, 6)):
                found = changed.contacts(*q)
                assert found == fresh.contacts(*q)
                assert changed.clear(*q) == (not found)
                touched += bool(found)
    assert 0 < touched < 720


def test_a_set_of_bodies_that_comes_back_is_not_made_anew(embodiment) -> None:
    checker, state = CollisionChecker(embodiment), State(1)
    checker.set_obstacles(state.obstacles())
    checker.clear(ZERO, ZERO)
    first = checker._model
    checker.attach("left", "a", IN_HAND)
    checker.clear(ZERO, ZERO)
    assert checker._model is not first
    checker.detach("left")
    checker.set_obstacles(state.obstacles())
    checker.clear(ZERO, ZERO)
    assert checker._model is first


def test_models_are_kept_while_they_are_small(embodiment, monkeypatch) -> None:
    checker = CollisionChecker(embodiment)

    def kept(most: int) -> int:
        monkeypatch.setattr("rtphys.plan.collision._KEPT_PAIRS", most)
        for k in range(6):
            thing = Obstacle(f"thing {k}", np.full(3, 0.03), Pose((0, 0, 2)))
            checker.set_obstacles([TABLE, thing])
            checker.clear(ZERO, ZERO)
        return len(checker._models)

    assert kept(10**6) == 6
    assert kept(3 * checker._model.pairs) == 3
    assert kept(1) == 1
