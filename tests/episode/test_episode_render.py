"""Pictures of states, and videos of evaluated episodes."""

from collections.abc import Iterator

import numpy as np
import pytest

from rtphys.assets.pack import Pack, default_pack
from rtphys.core.errors import BadValue
from rtphys.data.episode import Images
from rtphys.episode.generate import prepare
from rtphys.episode.render import (
    RenderedFrames,
    StateTrajectory,
    draw_together,
    montage,
    render_frames,
)
from rtphys.sim import renderer
from rtphys.spec.episode import EpisodeSpec, Recipe
from rtphys.spec.recording import RecordingSpec
from rtphys.task.spec import Task, load_task


def test_a_video_shows_the_head_over_both_wrists() -> None:
    pictures = {
        name: np.full((240, 320, 3), value, np.uint8)
        for name, value in (("head_camera", 10), ("left_camera", 20), ("right_camera", 30))
    }
    frame = montage(pictures)
    assert frame.shape == (360, 320, 3)
    assert (frame[:240] == 10).all()
    assert (frame[240:, :160] == 20).all() and (frame[240:, 160:] == 30).all()


@pytest.mark.sim
@pytest.mark.render
def test_what_is_drawn_together_is_what_is_drawn_alone() -> None:
    """Three tasks of different length, look, flicker and senses."""
    renderer.configure()
    recording, pack = RecordingSpec(("head", "left"), ("depth",), size="32x32"), default_pack()

    def begun() -> list[RenderedFrames]:
        return [render_frames(*one, recording) for one in tried]

    tried = list[tuple[Recipe, Task, Pack, StateTrajectory]]()
    for count, name in enumerate(("click_bell", "lift_pot", "stack_blocks_two"), start=3):
        recipe, task = EpisodeSpec(name, "phys_random_all").at(2 * count), load_task(name)
        states = prepare(recipe, task, pack).world.scene.pack_poses()
        times = [0.06 * n for n in range(count)]
        tried.append((recipe, task, pack, StateTrajectory(times, [states] * count)))
    together, alone = begun(), begun()
    pictures = draw_together([one.images for one in together], [list] * len(tried))
    for one, other, seen in zip(alone, together, pictures, strict=True):
        one_by_one = list(one.images)
        assert len(seen) == len(one_by_one)
        for expected, picture in zip(one_by_one, seen, strict=True):
            assert expected.keys() == picture.keys()
            assert all((expected[name] == picture[name]).all() for name in expected)
        assert one.sensed is not None and other.sensed is not None
        for place, track in one.sensed.tracks.items():
            assert np.array_equal(np.stack(track), np.stack(other.sensed.tracks[place]))


@pytest.mark.sim
@pytest.mark.render
def test_a_consumer_that_fails_ends_what_is_drawn_together() -> None:
    renderer.configure()
    recipe, task, pack = EpisodeSpec("click_bell").at(0), load_task("click_bell"), default_pack()
    states = prepare(recipe, task, pack).world.scene.pack_poses()
    recording = RecordingSpec(("head",), size="32x32")
    trajectory = StateTrajectory([0.06 * n for n in range(5)], [states] * 5)
    group = [render_frames(recipe, task, pack, trajectory, recording).images for _ in range(2)]

    def fail(images: Iterator[Images]) -> int:
        next(images)
        raise BadValue("disk", "full", "some space")

    with pytest.raises(BadValue):
        draw_together(group, [fail, lambda images: len(list(images))])
