"""The terminal that tables, bars and live displays are drawn on."""

from collections.abc import Iterable

from rich.console import Console, ConsoleOptions, HighlighterType, JustifyMethod, OverflowMethod
from rich.console import RenderableType as Drawn
from rich.segment import Segment
from rich.style import Style
from rich.text import Text

from rtphys.cli.terminal import printable


class Screen(Console):
    """Shows every text as it is: without markup, emoji codes and control characters of its own."""

    def __init__(self, *, stderr: bool = False, width: int | None = None) -> None:
        super().__init__(stderr=stderr, width=width, markup=False, emoji=False, highlight=False)

    def render_str(
        self,
        text: str,
        *,
        style: str | Style = "",
        justify: JustifyMethod | None = None,
        overflow: OverflowMethod | None = None,
        emoji: bool | None = None,
        markup: bool | None = None,
        highlight: bool | None = None,
        highlighter: HighlighterType | None = None,
    ) -> Text:
        """Spelled before a column's width follows from it. Markup and emoji codes stay letters."""
        return Text(printable(text), style, justify=justify, overflow=overflow)

    def render(self, renderable: Drawn, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """Here all that is drawn comes by, whatever it was before."""
        for text, style, control in super().render(renderable, options):
            yield Segment(text if control else printable(text), style, control)
