"""One episode, one path: recipe -> physics -> world -> script -> success -> verdict."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from rtphys.assets.pack import Pack
from rtphys.core import arithmetic
from rtphys.core.errors import Infeasible
from rtphys.core.timing import PhaseTimer
from rtphys.expert.robot import ExpertRobot
from rtphys.physics.domain import CENTER_OF_MASS, Domain
from rtphys.physics.enforce import check_in_force, enforce
from rtphys.physics.handles import Blueprint
from rtphys.physics.hull import Solid, inside
from rtphys.physics.reach import keys_of, reach
from rtphys.physics.values import Physics
from rtphys.sim.recorder import FRAME_STEPS, Recording
from rtphys.sim.rollout import Outcome, Rollout, RolloutOptions
from rtphys.sim.room import TablePlan
from rtphys.sim.world import World, WorldPlan
from rtphys.spec.episode import Recipe
from rtphys.spec.protocol import VisualRandomization, load_look
from rtphys.task.props import Ball, Prop, check_props
from rtphys.task.spec import Task
from rtphys.visual.look import CLEAN, Look, draw_look

MAX_SLIDE = 0.05  # [m] and
MAX_TURN = 0.26  # [rad], 15 deg: an object that settled further away has fallen or run off


@dataclass(frozen=True, eq=False)
class Instance:
    """One episode before anyone acts in it."""

    recipe: Recipe
    task: Task
    domain: Domain
    props: tuple[Prop, ...]
    physics: Physics
    world: World
    look: Look = CLEAN


def prepare(
    recipe: Recipe, task: Task, pack: Pack, visuals: bool = False, look: str | None = None
) -> Instance:
    """Draw, build, enforce.

    Args:
        look: name of the textures and lights that are drawn (`load_look`); None: the recipe's own.

    Raises `Infeasible`: "layout" or "invalid_physics"; `UnknownName`: physics of a prop that the
    task has not, or that cannot have it.
    """
    arithmetic.warn()
    spec, seed, props = recipe.spec, recipe.seed, tuple(task.props(recipe.seed))
    rules, blueprint = spec.rules, Blueprint()
    first = rules.draw(seed)
    check_props(first, props)
    enforce(blueprint, first)
    shown = rules.visual if look is None else under_look(rules.visual, look)
    drawn = draw_look(shown, rules.chance(seed), (task, props), pack, spec.split)
    table = TablePlan(task.table_shift, task.table_drop)
    if visuals and drawn.table_texture is not None:
        table = replace(table, texture=pack.texture("table", drawn.table_texture))
    if visuals and drawn.wall_texture is not None:
        table = replace(table, wall_texture=pack.texture("wall", drawn.wall_texture))
    robot, clutter = spec.embodiment, drawn.clutter
    plan = WorldPlan(pack, props, blueprint, table, robot, clutter=clutter, visuals=visuals)
    world = World(plan)
    # The centre of mass may only be drawn once the bodies it must lie in are known.
    solids = {body.name: Solid(body.hull, body.nominal_com) for body in world.bodies}
    smallest = rules.domain.smallest_scale / blueprint.object_scale
    physics = rules.draw(seed, inside(solids, smallest))
    _check_inside(physics, solids)
    enforce(world, physics)
    return Instance(recipe, task, rules.domain, props, physics, world, drawn)


def _check_inside(physics: Physics, solids: Mapping[str, Solid]) -> None:
    """A held centre of mass may lie outside a body, or a drawn one outside of a held size."""
    for key in keys_of(CENTER_OF_MASS, physics):
        offset = physics[key]
        if isinstance(offset, tuple) and not inside(solids)(offset, reach(key, physics)):
            raise Infeasible("invalid_physics", f"{key} {offset} lies outside a body")


def under_look(own: VisualRandomization | None, look: str) -> VisualRandomization | None:
    """Other textures and lights (`load_look`). Clutter and table height stay, as states need them.

    Raises `UnknownName`: no such protocol.
    """
    own = own or VisualRandomization()
    shown = replace(load_look(look), clutter=own.clutter, table_drop=own.table_drop)
    return None if shown == VisualRandomization() else shown


def settle(instance: Instance) -> None:
    """Let everything come to rest where it was put. Raises `Infeasible`: "unsettled"."""
    world = instance.world
    for scene_object in world.objects.values():
        scene_object.roll_down()
    # Balls are poured in rather than placed: where they end is no matter of the layout.
    before = {
        name: scene_object.pose
        for name, scene_object in world.scene_objects.items()
        if scene_object.bodies and not isinstance(scene_object.prop, Ball)
    }
    world.settle()
    for name, start in before.items():
        now = world.scene_objects[name].pose
        slid, turned = float(((now.p - start.p) ** 2).sum() ** 0.5), start.angle_to(now)
        if slid > MAX_SLIDE or turned > MAX_TURN:
            moved = f"{name} moved {100 * slid:.1f} cm and turned {turned:.2f} rad while settling"
            raise Infeasible("unsettled", moved)


NO_LIMIT = RolloutOptions()  # of a policy, whose actions are counted and not its steps
POLL = FRAME_STEPS  # a demonstration's first success is known to one recorded frame, 60 ms


@dataclass(frozen=True, eq=False)
class Attempt:
    """The result of one recipe. `reason` is empty iff the attempt is accepted."""

    recipe: Recipe
    reason: str = ""
    detail: str = ""
    instance: Instance | None = None  # None when not even the world could be made
    recording: Recording | None = None
    outcome: Outcome | None = None

    @property
    def accepted(self) -> bool:
        return not self.reason


def attempt(
    recipe: Recipe,
    task: Task,
    pack: Pack,
    timer: PhaseTimer | None = None,
    touch: bool = False,
    happened: bool = False,
) -> Attempt:
    """Let the scripted expert try one episode. Never renders.

    Infeasibility is a result here, not an error.

    Args:
        timer: takes the time of the phases build, settle, plan and simulate.
        touch: record what the fingers feel, too; it moves nothing.
        happened: watch what happens, for labels (`assemble`); it moves nothing.
    """
    instance = rollout = None
    phases = timer or PhaseTimer()
    try:
        with phases.phase("build"):
            instance = prepare(recipe, task, pack)
        with phases.phase("settle"):
            settle(instance)
        with phases.phase("plan"):
            # The rollout times every step, which is too often for those who do not ask.
            options = RolloutOptions(
                task.step_limit, POLL, gentle=True, touch=touch, happened=happened, timer=timer
            )
            rollout = start(instance, options)
            task.script(ExpertRobot(rollout, recipe.stream("expert"), recipe.spec.recovery))
        with phases.phase("simulate"):
            outcome = rollout.finish()
    except Infeasible as problem:
        recording = rollout.recorder.recording if rollout else None
        return Attempt(recipe, problem.reason, problem.detail, instance, recording)
    recording = rollout.recorder.recording
    if outcome.held:
        return Attempt(recipe, "", "", instance, recording, outcome)
    reason = "failed_check" if outcome.first_success is None else "not_held"
    return Attempt(recipe, reason, outcome.detail, instance, recording, outcome)


def start(instance: Instance, options: RolloutOptions = NO_LIMIT) -> Rollout:
    """Begin the policy stage of a settled instance. Raises `FalseLabel`: its physics is another."""
    recipe = instance.recipe
    check_in_force(instance.world, instance.physics, f"{recipe.task}, seed {recipe.seed}")
    condition = instance.task.condition(list(instance.props))
    return Rollout(instance.world, instance.physics, condition, options)
