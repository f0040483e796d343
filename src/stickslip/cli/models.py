"""``stickslip models``."""

from typing import Any

from rich.text import Text

from stickslip.cli.output import document, plain, print_json, show_table, stdout
from stickslip.errors import UnknownNameError
from stickslip.friction import PRINTED_FORMS, SOURCES, BristleLaw, FrictionLaw, PrintedForm, laws
from stickslip.quantities import Quantity, fields_of

__all__ = ["run"]


def run(name: str | None, *, published: bool, as_json: bool) -> None:
    """List laws, or show one."""
    if name is not None:
        _one(name, as_json=as_json)
    elif published:
        _printed(as_json=as_json)
    else:
        _all(as_json=as_json)


def _all(*, as_json: bool) -> None:
    if as_json:
        print_json(document("models", {"laws": [_law(law) for law in laws().values()]}))
        return
    rows = [
        [
            name,
            law.title,
            "bristles" if issubclass(law, BristleLaw) else "set-valued",
            ", ".join(quantity.symbol for quantity in fields_of(law).values()),
        ]
        for name, law in laws().items()
    ]
    show_table("", ["law", "title", "kind", "parameters"], rows)
    stdout().print("\nOne in full: stickslip models NAME. As printed: stickslip models --published")


def _printed(*, as_json: bool) -> None:
    if as_json:
        forms = [_form(form) for form in PRINTED_FORMS.values()]
        print_json(document("models", {"printed": forms}))
        return
    for form in PRINTED_FORMS.values():
        _show_form(form)


def _show_form(form: type[PrintedForm]) -> None:
    console = stdout()
    console.print(Text.assemble((f"eq. {form.equation} {form.title}", "bold"), f" ({form.name})"))
    console.print(f"  as printed  {form.formula}", markup=False)
    console.print(f"  wrong       {form.defect}", markup=False)
    if form.right:
        console.print(f"  right       {form.right}", markup=False)
    console.print(f"  used here   {form.cure} ({form.corrected.name})\n", markup=False)


def _one(name: str, *, as_json: bool) -> None:
    if name in PRINTED_FORMS:
        form = PRINTED_FORMS[name]
        if as_json:
            print_json(document("models", _form(form)))
        else:
            _show_form(form)
        return
    if name not in laws():
        raise UnknownNameError("friction law", name, [*laws(), *PRINTED_FORMS])
    law = laws()[name]
    if as_json:
        print_json(document("models", _law(law)))
        return
    console = stdout()
    console.print(law.title, markup=False, style="bold")
    console.print(f"{next(iter((law.__doc__ or '').splitlines()), '')}\n", markup=False)
    console.print(f"{law.formula}\n", markup=False)
    rows = [
        [field, quantity.symbol, quantity.unit, quantity.range, _default(law, field)]
        for field, quantity in fields_of(law).items()
    ]
    show_table("", ["parameter", "symbol", "unit", "range", "default"], rows)
    console.print()
    for key in law.sources:
        console.print(plain(SOURCES[key]), markup=False)


def _default(law: type[FrictionLaw], field: str) -> str:
    default = law.__dataclass_fields__[field].default
    if isinstance(default, (int, float)):
        return f"{default:g}"
    return "none" if default is None else "required"


def _quantity(quantity: Quantity) -> dict[str, Any]:
    return {"symbol": quantity.symbol, "unit": quantity.unit, "range": quantity.range}


def _law(law: type[FrictionLaw]) -> dict[str, Any]:
    return {
        "name": law.name,
        "title": law.title,
        "kind": "bristle" if issubclass(law, BristleLaw) else "set-valued",
        "formula": law.formula,
        "parameters": {
            field: {**_quantity(quantity), "default": _default(law, field)}
            for field, quantity in fields_of(law).items()
        },
        "sources": [SOURCES[key] for key in law.sources],
    }


def _form(form: type[PrintedForm]) -> dict[str, Any]:
    return {
        "name": form.name,
        "title": form.title,
        "equation": form.equation,
        "as_printed": form.formula,
        "defect": form.defect,
        "right": form.right,
        "cure": form.cure,
        "corrected_law": form.corrected.name,
    }
