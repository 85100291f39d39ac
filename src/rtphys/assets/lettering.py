"""Words on small pictures, in letters of 3 x 5 dots: no font gives the same pixels everywhere."""

import numpy as np
from numpy.typing import NDArray

from rtphys.assets.material import Colour

Array = NDArray[np.float64]

# A letter is five rows of three dots; each row is an octal digit, its highest bit the left dot.
LETTERS = {
    "A": 0o25755, "B": 0o65656, "C": 0o34443, "D": 0o65556, "E": 0o74647, "F": 0o74644,
    "G": 0o34553, "H": 0o55755, "I": 0o72227, "J": 0o11152, "K": 0o55655, "L": 0o44447,
    "M": 0o57755, "N": 0o65555, "O": 0o25552, "P": 0o65644, "Q": 0o25563, "R": 0o65655,
    "S": 0o34216, "T": 0o72222, "U": 0o55557, "V": 0o55522, "W": 0o55775, "X": 0o55255,
    "Y": 0o55222, "Z": 0o71247, "0": 0o75557, "1": 0o26227, "2": 0o71747, "3": 0o71717,
    "4": 0o55711, "5": 0o74717, "6": 0o74757, "7": 0o71111, "8": 0o75757, "9": 0o75717,
    ":": 0o02020, ".": 0o00002, "-": 0o00700, " ": 0o00000,
}  # fmt: skip


def dots(text: str) -> NDArray[np.bool_]:
    """Dots (5, 4 n - 1) of a text of n capitals. Raises KeyError for other characters."""
    rows = np.zeros((5, 4 * len(text)), bool)
    for i, letter in enumerate(text):
        code = LETTERS[letter]
        for r in range(5):
            for c in range(3):
                rows[r, 4 * i + c] = bool(code >> (3 * (4 - r) + 2 - c) & 1)
    return rows[:, :-1]


def write(canvas: Array, text: str, row: int, colour: Colour, size: int = 1) -> Array:
    """Paint `text` centred on a canvas (h, w, 3) from pixel row `row`, `size` pixels per dot."""
    pattern = np.kron(dots(text), np.ones((size, size), bool))
    height, width = pattern.shape
    left = (canvas.shape[1] - width) // 2
    if left < 0 or row + height > canvas.shape[0]:
        raise ValueError(f"{text!r} is {width} x {height} pixels: too large for {canvas.shape}")
    canvas[row : row + height, left : left + width][pattern] = colour
    return canvas
