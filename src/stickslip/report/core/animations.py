"""Moving pictures in reports."""

from dataclasses import dataclass
from typing import ClassVar, final

from markupsafe import Markup

from stickslip.errors import InputError

BEGIN, END = '<figure class="animation">', "</figure>"


@final
@dataclass(frozen=True, kw_only=True)
class Animation:
    """A moving picture with its caption.

    Parameters
    ----------
    html : str
        What `stickslip.plots.animation_html` returns. It goes into the page unescaped.
    caption : str
        Begins with a bold name and says what to see.

    Raises
    ------
    InputError
        If it is something else, or carries a script.

    Examples
    --------
    >>> html = '<figure class="animation"><picture></picture></figure>'
    >>> Animation(html=html, caption="**The cart** in two cycles.").template
    'figure'
    """

    template: ClassVar[str] = "figure"
    html: str
    caption: str = ""

    def __post_init__(self) -> None:
        """Check that it is a figure of its own."""
        whole = self.html.startswith(BEGIN) and self.html.endswith(END)
        if not whole or "<script" in self.html:
            raise InputError(
                "Animation.html must be what stickslip.plots.animation_html returns, got"
                f" {self.html[:40]!r}."
            )

    @property
    def markup(self) -> Markup:
        """The picture, ready for the page."""
        return Markup(self.html.removeprefix(BEGIN).removesuffix(END))  # checked above
