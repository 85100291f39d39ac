"""LeRobot v2.1, which openpi and GR00T read: one parquet file and one video an episode."""

from pathlib import Path

from rtphys.assets.action_layout import SIDES
from rtphys.data.dataset import Episode
from rtphys.data.files import make_folder, write_synced
from rtphys.data.json_text import compact, plain, pretty
from rtphys.data.video import VideoWriter
from rtphys.export import lerobot_episode as one
from rtphys.export.lerobot_plan import CHUNK, RATE, ROBOT, Plan
from rtphys.export.statistics import to_json
from rtphys.export.tables import frame_table, write_table

DATA_PATH = "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet"
VIDEO_PATH = "videos/chunk-{episode_chunk:03d}/{video_key}/episode_{episode_index:06d}.mp4"
KEYFRAMES = 2


class WriterV2:
    """Takes episodes in order, then `finish`."""

    def __init__(self, root: Path, plan: Plan) -> None:
        self.root, self.plan = root, plan
        self._tasks: dict[str, int] = {}
        self._episodes: list[dict[str, object]] = []
        self._stats: list[dict[str, object]] = []
        self._frames = 0

    def add(self, episode: Episode) -> None:
        """Writes one episode."""
        sentence = one.sentence(episode)
        task = self._tasks.setdefault(sentence, len(self._tasks))
        at = one.Position(len(self._episodes), self._frames, task)
        columns = one.columns_of(episode, at)
        writers = {c: VideoWriter(*self.plan.size, RATE, KEYFRAMES) for c in self.plan.cameras}
        pixels = one.encode(episode, self.plan, writers)
        spot = {"episode_chunk": at.episode // CHUNK, "episode_index": at.episode}
        for camera, writer in writers.items():
            name = VIDEO_PATH.format(video_key=self.plan.video_key(camera), **spot)
            make_folder((self.root / name).parent)
            write_synced(self.root / name, writer.finish())
        write_table(frame_table(columns), self.root / DATA_PATH.format(**spot))
        rows = len(columns["index"])
        record = {"episode_index": at.episode, "tasks": [sentence], "length": rows}
        self._episodes.append(record | one.labels(episode))
        stats = one.statistics(columns, pixels, self.plan)
        spelt = {name: to_json(part) for name, part in stats.items()}
        self._stats.append({"episode_index": at.episode, "stats": spelt})
        self._frames += rows

    def finish(self) -> None:
        """Writes `meta/`."""
        meta = self.root / "meta"
        make_folder(meta)
        tasks = [{"task_index": n, "task": text} for text, n in self._tasks.items()]
        tables = {"episodes": self._episodes, "tasks": tasks, "episodes_stats": self._stats}
        for name, rows in tables.items():
            lines = b"".join(compact(plain(row)) + b"\n" for row in rows)
            write_synced(meta / f"{name}.jsonl", lines)
        write_synced(meta / "modality.json", pretty(plain(self._modality())))
        write_synced(meta / "info.json", pretty(plain(self._info()), sort=False))

    def _modality(self) -> dict[str, object]:
        """GR00T's slices of the vectors."""
        parts: dict[str, object] = {}
        layout = self.plan.layout
        for side, arm, gripper in zip(SIDES, layout.arms, layout.grippers, strict=True):
            parts[f"{side}_arm"] = {"start": arm.start, "end": arm.stop}
            parts[f"{side}_gripper"] = {"start": gripper, "end": gripper + 1}
        videos = {
            name: {"original_key": self.plan.video_key(c)} for c, name in self.plan.cameras.items()
        }
        annotation = {"human.task_description": {"original_key": "task_index"}}
        return {"state": parts, "action": parts, "video": videos, "annotation": annotation}

    def _info(self) -> dict[str, object]:
        total = len(self._episodes)
        return {
            "codebase_version": "v2.1",
            "robot_type": ROBOT,
            "total_episodes": total,
            "total_frames": self._frames,
            "total_tasks": len(self._tasks),
            "total_videos": total * len(self.plan.cameras),
            "total_chunks": -(-total // CHUNK),
            "chunks_size": CHUNK,
            "fps": float(RATE),
            "splits": {"train": f"0:{total}"},
            "data_path": DATA_PATH,
            "video_path": VIDEO_PATH,
            "features": self.plan.features(),
        }
