"""How the same setting is given in Python, as an option of a command, and in a rig file."""

import re
from typing import Final, Literal, TypeAlias

Speaker: TypeAlias = Literal["python", "options", "rig"]
"""Who says how files are read: a call, the options of a command, or a rig file."""

_SETTING: Final = re.compile(
    r"""\b(?P<setting>columns|units|gain|repair|conditions)=
        (?:"(?P<word>\w+)"|\{"(?P<name>[\w.]+)":\ (?P<value>"[^"]*"|\[[^\]]*\]|[^"}]+)\})""",
    re.VERBOSE,
)
MOTOR_KEY: Final = "motor_constant = "
_OPTIONS: Final = {"units": "unit"}
"""Options that are called otherwise."""


def spelled(text: str, by: Speaker) -> str:
    """Return a message with the settings that it names as they are given there.

    Examples
    --------
    >>> said = 'Give columns={"position": "..."} and repair="sort".'
    >>> spelled(said, "options")
    'Give --columns position=... and --repair sort.'
    >>> spelled(said, "rig")
    'Give columns = { position = "..." } and repair = ["sort"].'
    """
    if by == "python":
        return text
    text = text.replace("motor_constant=", "--motor-constant " if by == "options" else MOTOR_KEY)
    return _SETTING.sub(_option if by == "options" else _key, text)


def _option(found: re.Match[str]) -> str:
    setting = _OPTIONS.get(found["setting"], found["setting"])
    if found["word"]:
        return f"--{setting} {found['word']}"
    value = ",".join(part.strip(' "') for part in found["value"].strip("[]").split(","))
    pair = f"{found['name']}={value}"
    return f'--{setting} "{pair}"' if " " in pair else f"--{setting} {pair}"


def _key(found: re.Match[str]) -> str:
    if found["word"]:
        return f'{found["setting"]} = ["{found["word"]}"]'
    return f"{found['setting']} = {{ {found['name']} = {found['value']} }}"
