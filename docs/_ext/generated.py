"""Reference pages made from the package itself: laws, printed forms, command line, rig files."""

import inspect
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, ClassVar

import typer.main
from docutils import nodes
from docutils.statemachine import StringList
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from stickslip.cli.app import app as command_line
from stickslip.data import rig_schema
from stickslip.friction import LAWS, PRINTED_EQUATIONS, FrictionLaw, said_of
from stickslip.identify import USUAL_LAWS, BandVerdict
from stickslip.identify.kinds.registry import kinds
from stickslip.quantities import fields_of

GREEK = ("alpha", "beta", "mu", "phi", "rho", "sigma")
RIG_LISTS = {
    "RunTable": "[run]",
    "TrialTable": "[[trial]]",
    "DataTable": "[data]",
    "PublishedTable": "[[published]]",
}


def table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Iterator[str]:
    """Lines of a table."""
    for cells in (head, ("---",) * len(head), *rows):
        yield "| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |"
    yield ""


def symbol(text: str) -> str:
    """A plain symbol such as mu_s as a formula."""
    base, _, index = text.partition("_")
    base = f"\\{base}" if base in GREEK else base
    return f"${base}_{{{index}}}$" if index else f"${base}$"


def law_table() -> Iterator[str]:
    """All registered laws in one table."""
    rows = (
        (
            f"[{law.title}](#law-{name})",
            f"`{name}`",
            f"`{law.composition}`",
            law.passivity.condition if law.passivity else "not known",
        )
        for name, law in LAWS.items()
    )
    yield from table(("law", "name", "composition", "passive"), rows)


def requested_laws() -> Iterator[str]:
    """The default candidates on travels, and which laws the values of a rig file are for."""
    shared = [name for name, law in LAWS.items() if not law.on_request]
    yield (
        f"Travels are compared by default with {_listed(USUAL_LAWS)}; name others to compare them."
        f" Values directly under `[friction]` of a rig file are those of {_listed(shared)}, and of"
        " laws with a table or a parameter of their own there."
    )


def _listed(names: Sequence[str]) -> str:
    *first, last = (f"`{name}`" for name in names)
    return f"{', '.join(first)} and {last}"


def laws() -> Iterator[str]:
    """All registered laws, a section for each."""
    for name, law in LAWS.items():
        yield from one_law(name, law)


def one_law(name: str, law: type[FrictionLaw]) -> Iterator[str]:
    prose = inspect.cleandoc(vars(law).get("__doc__") or "").partition("\n\nNotes\n-")[0]
    yield from (f"(law-{name})=", f"## {law.title}", "")
    yield from (prose, "", "$$", law.formula, "$$", "")
    rows = (
        (
            f"`{field}`",
            symbol(quantity.symbol),
            quantity.unit,
            bounds(quantity),
            default(law, field),
        )
        for field, quantity in fields_of(law).items()
    )
    yield from table(("parameter", "symbol", "unit", "range", "default"), rows)
    for heading, text in said_of(law):
        yield f"- {heading}: " + (
            f"`{text}`" if heading == "Composition" else text.rstrip(".") + "."
        )
    yield ""
    yield f"In Python: {{py:obj}}`stickslip.{law.__name__}`."
    yield f"Sources: {{cite}}`{','.join(law.sources)}`."
    yield ""


def bounds(quantity: Any) -> str:
    """The allowed range; the name of a field in it is code."""
    text: str = quantity.range
    name = quantity.at_least
    return text.replace(f"at least {name}", f"at least `{name}`") if name else text


def default(owner: type[Any], field: str) -> str:
    value = owner.__dataclass_fields__[field].default
    if isinstance(value, (int, float)):
        return f"{value:g}"
    return "none" if value is None else "required"


def printed_forms() -> Iterator[str]:
    """The printed equations: formula, what is wrong, what is used instead."""
    for form in PRINTED_EQUATIONS:
        yield from (f"## Eq. {form.equation}: {form.title}", "")
        yield from ("$$", form.formula, "$$", "")
        if form.defect:
            yield from ("Defect", f": {typeset(form.defect)}.", "")
        if form.right:
            yield from (
                "Right" if form.defect else "Right as printed",
                f": {typeset(form.right)}.",
                "",
            )
        if form.corrected:
            yield from (
                "Used here",
                f": {typeset(form.cure)}; the law `{form.corrected.name}`.",
                "",
            )
            yield from ("Class", f": `stickslip.friction.PRINTED_FORMS[{form.name!r}]`", "")


def typeset(text: str) -> str:
    """Return a text whose symbols stand between dollar signs with these as formulas."""
    text = re.sub(r"\$(\w+)\$", lambda found: symbol(found[1]), text)
    return re.sub(r"\^\{(\w+)\}", r"${}^{\1}$", text)


def commands() -> Iterator[str]:
    """All commands of the command line, from the text of their own help."""
    group: Any = typer.main.get_command(command_line)
    for name, command in leaves(group):
        parameters = [parameter for parameter in command.params if parameter.name != "help"]
        places = [f"[{p.name.upper()}]" for p in parameters if is_argument(p)]
        options = [] if len(places) == len(parameters) else ["[OPTIONS]"]
        usage = " ".join(["stickslip", name, *options, *places])
        yield from (f"## `stickslip {name}`", "", command.help, "")
        yield from ("```text", usage, "```", "")
        if parameters:
            rows = ((called(p), p.help or "", preset(p)) for p in parameters)
            yield from table(("argument or option", "meaning", "default"), rows)


def leaves(group: Any, above: str = "") -> Iterator[tuple[str, Any]]:
    """Commands by all their words, those of groups too."""
    for name, command in group.commands.items():
        if hasattr(command, "commands"):
            yield from leaves(command, f"{above}{name} ")
        else:
            yield above + name, command


def is_argument(parameter: Any) -> bool:
    return bool(parameter.param_type_name == "argument")


def called(parameter: Any) -> str:
    if is_argument(parameter):
        return f"`{parameter.name.upper()}`"
    metavar = f" {parameter.metavar}" if parameter.metavar else ""
    return f"`{', '.join(parameter.opts)}{metavar}`"


def preset(parameter: Any) -> str:
    value = parameter.default
    plain = isinstance(value, (str, int, float)) and not isinstance(value, bool)
    return f"`{value}`" if plain or type(value).__name__ == "PosixPath" else ""


def rig_file() -> Iterator[str]:
    """All tables of a rig file, read off its schema."""
    schema = rig_schema()
    tables = schema["$defs"]
    mechanisms = schema["properties"]["mechanism"]["discriminator"]["mapping"]
    used = {reference.rpartition("/")[2] for reference in mechanisms.values()}
    drives = dict(drive_mapping([tables[name] for name in used]))
    yield from ("## The file", "", *rig_table(schema))
    for heading, types in (("`[mechanism]`", mechanisms), ("`drive`", drives)):
        yield from (f"## {heading}", "")
        for kind, reference in sorted(types.items()):
            own = tables[reference.rpartition("/")[2]]
            yield from (f'### `type = "{kind}"`', "", own["description"], "", *rig_table(own))
    parts = dict.fromkeys(part_names([tables[name] for name in sorted(used)], drives))
    yield from ("## Parts of mechanisms", "")
    for name in parts:
        yield from (f"### `{name}`", "", tables[name]["description"], "", *rig_table(tables[name]))
    for name in ("Friction", *(LAWS[key].__name__ for key in LAWS)):
        key = next((key for key in LAWS if LAWS[key].__name__ == name), "")
        heading = f"### `[friction.{key}]`" if key else "## `[friction]`"
        yield from (heading, "", tables[name]["description"], "", *rig_table(tables[name]))
    for name, heading in RIG_LISTS.items():
        yield from (f"## `{heading}`", "", tables[name]["description"], "")
        yield from rig_table(tables[name])


def drive_mapping(node: Any) -> Iterator[tuple[str, str]]:
    """Types of drives: the choices that a mechanism's table offers."""
    if isinstance(node, dict):
        yield from node.get("discriminator", {}).get("mapping", {}).items()
    inner = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
    for child in inner:
        yield from drive_mapping(child)


def part_names(node: Any, drives: dict[str, str]) -> Iterator[str]:
    """Names of the tables of parts, such as rotors: what tables refer to and is no choice."""
    if isinstance(node, dict) and "discriminator" not in node:
        if "$ref" in node and node["$ref"] not in drives.values():
            yield node["$ref"].rpartition("/")[2]
        for child in node.values():
            yield from part_names(child, drives)
    elif isinstance(node, list):
        for child in node:
            yield from part_names(child, drives)


def rig_table(schema: dict[str, Any]) -> Iterator[str]:
    required = schema.get("required", ())
    rows = []
    for key, about in schema["properties"].items():
        if key == "type":
            continue
        value = about.get("default")
        given = value not in (None, "", [], {}) and not isinstance(value, dict)
        preset = str(value).lower() if isinstance(value, bool) else f"{value}"
        state = "required" if key in required else (f"`{preset}`" if given else "")
        rows.append((f"`{key}`", kind_of(about), state))
    yield from table(("key", "value", "default"), rows)


def kind_of(about: dict[str, Any]) -> str:
    """What may stand there, in words."""
    if "enum" in about:
        return "one of " + ", ".join(f"`{choice}`" for choice in about["enum"])
    kinds = [about, *about.get("anyOf", ())]
    if any("$ref" in kind or "oneOf" in kind for kind in kinds):
        return "; ".join(["a table", *([about["description"]] if "description" in about else [])])
    if "description" in about:
        return quantity_text(about["description"])
    words = {
        "string": "text",
        "boolean": "`true` or `false`",
        "array": "a list",
        "number": "a number",
    }
    return ", ".join(dict.fromkeys(words[k["type"]] for k in kinds if k.get("type") in words))


def quantity_text(description: str) -> str:
    """A description such as "mu_s [1], at least 0" with its symbol typeset."""
    name, bracket, rest = description.partition(" [")
    return f"{symbol(name)} [{rest}" if bracket else description


def verdict_file() -> Iterator[str]:
    """All parts of the document of a verdict with a band, read off its schema."""
    schema = BandVerdict.schema()
    parts = {"": schema, **{f" of `{key}`": one for key, one in nested(schema["properties"])}}
    parts |= {f": {name}": one for name, one in schema["$defs"].items() if "properties" in one}
    for where, part in parts.items():
        yield from (f"## {'Parts' if where else 'The document'}{where}", "")
        rows = ((f"`{key}`", typed(one), said(one)) for key, one in part["properties"].items())
        yield from table(("key", "value", "meaning"), rows)


def nested(properties: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Parts that have parts of their own, but for those whose keys are paths."""
    for key, one in properties.items():
        if "properties" in one and one.get("additionalProperties") is False:
            yield key, one


def typed(about: dict[str, Any]) -> str:
    """What stands there, in words."""
    if "enum" in about or "const" in about:
        return " or ".join(f"`{one}`" for one in about.get("enum", [about.get("const")]))
    if "$ref" in about:
        name = about["$ref"].rpartition("/")[2]
        return {"share": "number from 0 to 1", "numbers": "list of numbers"}.get(name, name)
    if "items" in about:
        return f"list: {typed(about['items'])}"
    kinds = about["type"] if isinstance(about["type"], list) else [about["type"]]
    return " or ".join({"string": "text"}.get(one, one) for one in kinds)


def said(about: dict[str, Any]) -> str:
    """The meaning of a part, as its description states it."""
    text: str = about.get("description", "")
    return text


def route_table() -> Iterator[str]:
    """All kinds of measurement in one table, in the order in which they are tried."""
    rows = (
        (
            kind.measured,
            ", ".join(f"`{name}`" for name in kind.routes),
            (kind.__doc__ or "").partition("\n")[0],
            ", ".join(f"`{name}`" for name in sorted(kind.uses | kind.settings)),
            "yes" if kind.simulated else "no",
        )
        for kind in kinds()
    )
    head = ("measurement", "route", "method", "options", "`law.toml`")
    yield from table(head, rows)


CONTENT = {
    "law-table": law_table,
    "laws": laws,
    "requested-laws": requested_laws,
    "printed-forms": printed_forms,
    "commands": commands,
    "rig-file": rig_file,
    "routes": route_table,
    "verdict-file": verdict_file,
}


class Generated(SphinxDirective):
    """``{generated} laws``: the page content of that name, only sections or none at all."""

    required_arguments = 1
    written: ClassVar = CONTENT
    """Functions that write each content, by its name."""

    def run(self) -> list[nodes.Node]:
        lines = "\n".join(self.written[self.arguments[0]]()).splitlines()
        parent = nodes.section()
        parent.document = self.state.document
        content = StringList(lines, source=self.get_source_info()[0])
        self.state.nested_parse(content, self.content_offset, parent, match_titles=True)
        return parent.children


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_directive("generated", Generated)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
