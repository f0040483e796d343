"""``stickslip models`` and ``stickslip cite``: the laws and their sources."""

from dataclasses import fields
from textwrap import fill, indent
from typing import Any

from rich.text import Text

from stickslip import friction
from stickslip.cli.console import plain, print_json, show_table, stdout
from stickslip.cli.options import CiteOptions, ModelsOptions, SchemaOptions
from stickslip.errors import UnknownNameError
from stickslip.mechanisms import Mechanism, mechanisms
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS
from stickslip.quantities import Quantity, fields_of
from stickslip.show.described import texts_below
from stickslip.show.documents import document
from stickslip.show.formatting import capital, number
from stickslip.show.report import formula_text, published_dict
from stickslip.show.report import plain as plain_text

INDENT = "    "
"""Before a formula and its notes."""


def run(options: ModelsOptions) -> None:
    """List laws and mechanisms, or show one."""
    if options.name is not None:
        _one(options.name, as_json=options.as_json)
    elif options.published:
        _printed(as_json=options.as_json)
    else:
        _all(as_json=options.as_json)


def _all(*, as_json: bool) -> None:
    if as_json:
        contacts = {name: kind.contact_names or "one" for name, kind in mechanisms().items()}
        result = {"laws": [_law(law) for law in friction.laws().values()], "mechanisms": contacts}
        print_json(document("models", result))
        return
    rows = [
        [name, law.title, str(law.composition or "")] for name, law in friction.listed().items()
    ]
    show_table("", ["law", "title", "composition"], rows)
    stdout().print()
    names = [[name, kind.contact_names or "one"] for name, kind in mechanisms().items()]
    show_table("", ["mechanism", "contacts"], names)
    stdout().print("\nDetails: stickslip models NAME. As printed: stickslip models --published")


def _printed(*, as_json: bool) -> None:
    if as_json:
        forms = list(map(published_dict, friction.PRINTED_EQUATIONS))
        print_json(document("models", {"printed": forms}))
        return
    for form in friction.PRINTED_EQUATIONS:
        _show_form(form)


def _show_form(form: type[friction.PrintedForm] | friction.RightEquation) -> None:
    console = stdout()
    name = f" ({form.name})" if form.name else ""
    console.print(Text.assemble((f"{form.equation} {form.title}", "bold"), name))
    console.print(indent(formula_text(form.formula), INDENT), soft_wrap=True)
    notes = {
        "defect": form.defect,
        "correct" if form.defect else "correct as printed": form.right,
        "used here": f"{form.cure} ({form.corrected.name})" if form.corrected else "",
    }
    for key, text in notes.items():
        if text:
            console.print(_note(f"{key}: {plain_text(text)}", console.width))
    console.print()


def _note(text: str, width: int) -> str:
    return fill(text, width, initial_indent=INDENT, subsequent_indent=f"{INDENT}  ")


def _one(name: str, *, as_json: bool) -> None:
    if name in friction.PRINTED_FORMS:
        form = friction.PRINTED_FORMS[name]
        if as_json:
            print_json(document("models", published_dict(form)))
        else:
            _show_form(form)
        return
    if name in mechanisms():
        _mechanism(mechanisms()[name], as_json=as_json)
        return
    if name not in friction.laws() and not friction.is_composition(name):
        known = [*friction.laws(), *friction.PRINTED_FORMS, *mechanisms()]
        raise UnknownNameError("friction law or mechanism", name, known)
    law = friction.law_type(name)
    if as_json:
        print_json(document("models", _law(law)))
        return
    console = stdout()
    console.print(law.title, style="bold")
    console.print(f"{_first_line(law)}\n")
    console.print(f"{formula_text(law.formula)}\n", soft_wrap=True)
    _show_parameters(law)
    console.print()
    for wanted in law.inputs:
        told = CONTACT_INPUTS[wanted]
        text = f"Contact input {wanted} [{told.unit}]: {told.meaning}"
        console.print(text, soft_wrap=True)
    for heading, text in friction.said_of(law):
        console.print(f"{heading}: {text}")
    console.print()
    for key in law.sources:
        console.print(plain(friction.SOURCES[key]))


def _mechanism(kind: type[Mechanism], *, as_json: bool) -> None:
    """Show a mechanism: its parameters, and its other fields, such as drives and parts."""
    texts = texts_below(kind)
    others = {
        field.name: " ".join(texts.get(field.name, "").split())
        for field in fields(kind)
        if field.name not in fields_of(kind)
    }
    if as_json:
        about = {
            "name": kind.name,
            "contacts": kind.contact_names or "one",
            "parameters": _parameters(kind),
            "fields": others,
        }
        print_json(document("models", about))
        return
    console = stdout()
    console.print(capital(kind.name.replace("-", " ")), style="bold")
    console.print(f"{_first_line(kind)}\n")
    _show_parameters(kind)
    if others:
        console.print()
    for field, text in others.items():
        console.print(f"{field}: {text}", soft_wrap=True)
    console.print(f"\nContacts: {kind.contact_names or 'one'}")


def _first_line(kind: type) -> str:
    return (vars(kind).get("__doc__") or "").partition("\n")[0]


def _show_parameters(kind: type[friction.FrictionLaw] | type[Mechanism]) -> None:
    rows = [
        [field, quantity.symbol, quantity.unit, quantity.range, _default(kind, field)]
        for field, quantity in fields_of(kind).items()
    ]
    if rows:
        show_table("", ["parameter", "symbol", "unit", "range", "default"], rows)


def _parameters(kind: type[friction.FrictionLaw] | type[Mechanism]) -> dict[str, Any]:
    return {
        field: {**_quantity(quantity), "default": _default(kind, field)}
        for field, quantity in fields_of(kind).items()
    }


def _default(law: type[friction.FrictionLaw] | type[Mechanism], field: str) -> str:
    default = law.__dataclass_fields__[field].default
    if isinstance(default, (int, float)):
        return number(default)
    return "none" if default is None else "required"


def _quantity(quantity: Quantity) -> dict[str, Any]:
    return {"symbol": quantity.symbol, "unit": quantity.unit, "range": quantity.range}


def _law(law: type[friction.FrictionLaw]) -> dict[str, Any]:
    return {
        "name": law.name,
        "title": law.title,
        "kind": "bristle" if law.states else "set-valued",
        "formula": law.formula,
        "parameters": _parameters(law),
        "inputs": {
            name: {"unit": CONTACT_INPUTS[name].unit, "meaning": CONTACT_INPUTS[name].meaning}
            for name in law.inputs
        },
        "sources": [friction.SOURCES[key] for key in law.sources],
        "composition": None if law.composition is None else str(law.composition),
        "typical": None if law.typical is None else _typical(law.typical),
        "passive": None if law.passivity is None else law.passivity.condition,
        "defects": law.defects,
        "compared": law.compared,
    }


def _typical(found: friction.Typical) -> dict[str, Any]:
    source = friction.SOURCES[found.source] if found.source else None
    return {"values": dict(found.values), "source": source}


def run_schema(_: SchemaOptions) -> None:
    """Print the schema."""
    from stickslip.data import rig_schema

    print_json(document("rig-schema", rig_schema()))


def run_cite(options: CiteOptions) -> None:
    """Print citations."""
    from stickslip import __version__

    own = f"stickslip {__version__}. The stickslip authors, 2026. BSD-3-Clause."
    chosen: Any = (
        [friction.law_type(name) for name in options.laws]
        if options.laws
        else list(friction.listed().values())
    )
    result = {law.name: [friction.SOURCES[key] for key in law.sources] for law in chosen}
    if options.as_json:
        content = {"software": own, "rig": friction.SOURCES["paper"], "laws": result}
        print_json(document("cite", content))
        return
    console = stdout()
    console.print(f"Software\n  {own}")
    console.print(f"Bundled rig\n  {friction.SOURCES['paper']}")
    for law in chosen:
        console.print(law.title)
        for source in result[law.name]:
            console.print(f"  {source}")
