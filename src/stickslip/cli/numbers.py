"""Numbers of options."""

from stickslip.errors import InputError, ParameterError
from stickslip.experiments import read_number
from stickslip.quantities import Quantity


def number_of(text: str, quantity: Quantity) -> float:
    """Return a number in SI, given plainly or with a unit.

    Examples
    --------
    >>> number_of("2 mm", Quantity("x", "m")), number_of("0.002", Quantity("x", "m"))
    (0.002, 0.002)
    """
    try:
        plain: str | float = float(text)
    except ValueError:
        plain = text
    return read_number(plain, quantity)


def range_of(option: str, text: str, quantity: Quantity) -> tuple[float, float]:
    """Return both ends of ``LOW..HIGH`` in SI.

    Examples
    --------
    >>> range_of("--between", "40 mm..0.1 m", Quantity("x_0", "m"))
    (0.04, 0.1)
    """
    low, dots, high = text.partition("..")
    if not (dots and low.strip() and high.strip()):
        raise InputError(f"{option} takes LOW..HIGH such as 40mm..100mm, got {text!r}.")
    try:
        return number_of(low.strip(), quantity), number_of(high.strip(), quantity)
    except ParameterError as error:
        raise ParameterError(f"{option} {error}") from None
