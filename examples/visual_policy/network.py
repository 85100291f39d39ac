"""The network: from features of each picture to points in it, then a multilayer perceptron."""

from dataclasses import asdict, dataclass

import torch
from pretrained import features
from sight import PICTURES
from torch import Tensor, nn

CHANNELS = 32  # maps that an encoder makes of them, each of which becomes one point
ARMS, GRIPPERS = [*range(6), *range(7, 13)], [6, 13]  # of an action's 14 numbers


@dataclass(frozen=True)
class Shape:
    """What a checkpoint must say so that its network can be built again."""

    chunk: int
    objects: int  # numbers of the objects' positions, which are predicted in training alone
    felt: int = 0  # numbers that are felt in a frame; 0: it feels nothing
    looks: int = 1  # how many frames are felt: this one, and earlier ones (`sight.looks`)
    hidden: int = 512

    def to_json(self) -> dict[str, int]:
        return asdict(self)


class Encoder(nn.Module):
    """Features of n pictures to points (n, 2 CHANNELS), -1..1, where maps of them are strongest."""

    def __init__(self, camera: str) -> None:
        super().__init__()
        count = features(PICTURES[camera][1])
        self.register_buffer("mean", torch.zeros(1, count, 1, 1))
        self.register_buffer("spread", torch.ones(1, count, 1, 1))
        self.maps = nn.Sequential(
            nn.Conv2d(count, 2 * CHANNELS, 1),
            nn.ReLU(),
            nn.Conv2d(2 * CHANNELS, 2 * CHANNELS, 3, padding=1),
            nn.ReLU(),
            nn.Conv2d(2 * CHANNELS, CHANNELS, 1),
        )

    def measure(self, fine: Tensor, coarse: Tensor) -> None:
        """Take mean and spread of each feature from samples."""
        joined = _joined(fine, coarse)
        self.mean.copy_(joined.mean((0, 2, 3), keepdim=True))
        self.spread.copy_(joined.std((0, 2, 3), keepdim=True) + 1e-3)

    def forward(self, fine: Tensor, coarse: Tensor) -> Tensor:
        maps = self.maps((_joined(fine, coarse) - self.mean) / self.spread)
        height, width = maps.shape[-2:]
        weight = maps.flatten(2).softmax(-1).unflatten(-1, (height, width))
        x = torch.linspace(-1, 1, width, device=maps.device)
        y = torch.linspace(-1, 1, height, device=maps.device)
        points = [(weight.sum(-2) * x).sum(-1), (weight.sum(-1) * y).sum(-1)]
        return torch.cat(points, dim=1)


def _joined(fine: Tensor, coarse: Tensor) -> Tensor:
    """All features at the finer resolution, (n, features, h, w)."""
    size = tuple(fine.shape[-2:])
    larger = nn.functional.interpolate(coarse.float(), size, mode="bilinear")
    return torch.cat([fine.float(), larger], dim=1)


class Network(nn.Module):
    """Features, command and what is felt to the next commands, and where the objects are.

    Arms are predicted relative to the command that is shown, openings as they are.
    """

    def __init__(self, shape: Shape) -> None:
        super().__init__()
        self.shape = shape
        self.head, self.wrist = Encoder("head"), Encoder("left")  # both wrists share one
        remembered = min(shape.felt * shape.looks, shape.hidden // 4)
        self.remember = (
            nn.Sequential(nn.Linear(shape.felt * shape.looks, remembered), nn.ReLU())
            if shape.looks > 1
            else nn.Identity()
        )
        inputs = 3 * 2 * CHANNELS + 14 + remembered
        self.body = nn.Sequential(
            nn.Linear(inputs, shape.hidden),
            nn.ReLU(),
            nn.Linear(shape.hidden, shape.hidden),
            nn.ReLU(),
        )
        self.actions = nn.Linear(shape.hidden, shape.chunk * 14)
        self.objects = nn.Linear(shape.hidden, shape.objects)
        for name, size in {"command": 14, "objects": shape.objects, "felt": shape.felt}.items():
            self.register_buffer(f"{name}_mean", torch.zeros(size))
            self.register_buffer(f"{name}_scale", torch.ones(size))

    def measure(self, name: str, samples: Tensor) -> None:
        """Take mean and spread of one of the inputs or of `objects` from samples (N, size)."""
        if not samples.shape[1]:
            return
        spread = samples.std(0)
        getattr(self, f"{name}_mean").copy_(samples.mean(0))
        # What never varies in training says nothing, whatever its value later.
        getattr(self, f"{name}_scale").copy_(torch.where(spread > 1e-4, spread, torch.inf))

    def forward(
        self,
        seen: dict[str, tuple[Tensor, Tensor]],
        command: Tensor,
        felt: Tensor,
    ) -> tuple[Tensor, Tensor]:
        """Commands (n, chunk, 14) and object positions (n, objects) [m].

        Args:
            seen: features by camera, fine and coarse (`pretrained.Seen`).
            command: (n, 14).
            felt: (n, looks, felt), now and before, as it is.
        """
        encoders = {"head": self.head, "left": self.wrist, "right": self.wrist}
        points = [encoder(*seen[camera]) for camera, encoder in encoders.items()]
        known = (command - self.command_mean) / self.command_scale
        feeling = (felt - self.felt_mean) / self.felt_scale
        feeling = self.remember(feeling.clamp(-5, 5).flatten(1))
        hidden = self.body(torch.cat([*points, known, feeling], dim=1))
        actions = self.actions(hidden).unflatten(1, (self.shape.chunk, 14))
        base = command.clone()
        base[:, GRIPPERS] = 0
        scale = torch.where(self.objects_scale.isinf(), 0.0, self.objects_scale)
        return actions + base[:, None], self.objects(hidden) * scale + self.objects_mean
