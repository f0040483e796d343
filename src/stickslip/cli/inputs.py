"""What commands are given: laws by file, option or rig, and what was measured."""

import dataclasses
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Generic, TypeVar

from stickslip.cli import console as terminal
from stickslip.cli import options as option_groups
from stickslip.cli.progress import Interrupts, Searching, Watching
from stickslip.data import (
    LOAD,
    CarriedLaw,
    Checks,
    KnownLaws,
    LawEstimates,
    Reading,
    Rig,
    carried,
    carried_by_contact,
    estimates_by_contact,
    grouped,
    load_rig,
    read_data,
    read_number,
)
from stickslip.errors import InputError, ParameterError, UnknownNameError, concerning, nearest
from stickslip.friction import (
    PRINTED_FORMS,
    FrictionLaw,
    Laws,
    PrintedForm,
    assigned,
    law_type,
    listed,
    specification,
)
from stickslip.identify import Wording, fits
from stickslip.identify.kinds import (
    AnyKind,
    Law,
    Request,
    as_judged,
    drawn_laws,
    kind_of,
    refuse_unused,
)
from stickslip.mechanisms import slip_of, static_normal_force
from stickslip.quantities import Quantity, all_paths, fields_of, full_path, parameters, vary
from stickslip.show.formatting import joined, number, printable, unit_text, within

# Which law a command takes, where a rig file and an option may name one, or a file of its own.


Friction = TypeVar("Friction", FrictionLaw, Laws)
USUAL_LAW = "coulomb"
FILE = re.compile(r"(?P<path>.*\.toml)(?::(?P<law>[a-z0-9-]+))?", re.IGNORECASE)
"""A file, and after a colon which of its laws."""
OTHER_FILES = (".json", ".html", ".csv")
"""Of a report, none of which is a rig file."""
FRICTION = "friction."


@dataclass(frozen=True, kw_only=True)
class _Chosen(Generic[Friction]):
    """What is to rub, and how well it is known."""

    carried: CarriedLaw[Friction]
    """The law, or laws by contact, with estimates, as transferred to this mechanism."""
    source: Rig | None = None
    """Where it was fitted, if that is another file than the rig's."""

    @property
    def law(self) -> Friction:
        """The law, or laws by contact, as on this mechanism."""
        return self.carried.law

    @property
    def estimates(self) -> LawEstimates | None:
        """Intervals and covariance of the parameters, if their file has them."""
        return self.carried.estimates

    @property
    def remarks(self) -> tuple[str, ...]:
        """What does not carry over from where it was fitted."""
        return self.carried.remarks


class ChosenLaw(_Chosen[FrictionLaw]):
    """A law and how well it is known."""


class ChosenLaws(_Chosen[Laws]):
    """Laws by contact and how well they are known."""


@dataclass(frozen=True, kw_only=True)
class ChosenForm:
    """An equation as printed in the paper."""

    form: PrintedForm
    """The equation, with its values."""
    corrected: FrictionLaw
    """Its corrected law, with the values of the rig."""
    estimates: None = None
    """Nothing is fitted to it."""
    remarks: tuple[str, ...] = ()
    """Nothing carries over."""
    source: None = None
    """It is from no file."""


def rig_and_form(options: option_groups.LawOptions) -> tuple[Rig, ChosenForm]:
    """Return the rig and an equation as printed, with the values that the rig has for its law."""
    assert options.law is not None
    if options.law_load is not None:
        raise InputError("--law-load applies to a law from a file: leave it out.")
    kind = PRINTED_FORMS[options.law]
    given = terminal.overrides(options.changes)
    own = {key: value for key, value in given.items() if key.startswith(FRICTION)}
    others = {key: value for key, value in given.items() if key not in own}
    rig = rig_with(options, others, law=kind.corrected.name)
    slip_of(rig.mechanism)
    law = _own(rig, kind.corrected.name).law
    load = static_normal_force(rig.mechanism) or 1.0
    values: dict[str, Any] = {}
    for name in fields_of(kind):
        value = load if name == "weight" else getattr(law, name, None)
        if value is not None:
            values[name] = value * load if name in PER_LOAD else value
    known = [field.name for field in dataclasses.fields(kind)]
    for key, text in own.items():
        name = key.removeprefix(FRICTION).removeprefix(f"{kind.name}.")
        if name not in known:
            raise InputError(
                f"--set {key} names no parameter of {kind.name}, which has {', '.join(known)}."
            )
        values[name] = _value_of(kind, name, text)
    return rig, ChosenForm(form=kind(**values), corrected=law)


PER_LOAD = ("bristle_stiffness", "bristle_damping")
"""Parameters that a law has over the load, and a printed equation as forces."""


def _value_of(kind: type[PrintedForm], name: str, text: str) -> float | bool:
    """Read a value of a printed equation, which may be a switch."""
    quantity = fields_of(kind).get(name)
    if quantity is not None:
        with concerning(f"--set {FRICTION}{name}:"):
            return read_number(text, quantity)
    if text.lower() not in ("true", "false"):
        raise ParameterError(f"--set {FRICTION}{name} must be true or false, got {text!r}.")
    return text.lower() == "true"


def friction_title(chosen: ChosenLaw | ChosenLaws | ChosenForm) -> str:
    """Return the law in words, or those of the contacts."""
    if isinstance(chosen, ChosenForm):
        return f"eq. {chosen.form.equation} as printed: {chosen.form.title}"
    if isinstance(chosen, ChosenLaw):
        return chosen.law.title
    return ", ".join(dict.fromkeys(law.title for _, law in chosen.law.members))


def rig_content(rig: Rig, chosen: ChosenLaw | ChosenLaws | ChosenForm) -> dict[str, Any]:
    """Return rig and name of its law, or those of the contacts, null where nothing rubs."""
    head: dict[str, Any] = {"rig": rig.heading, "digest": rig.digest}
    if isinstance(chosen, ChosenForm):
        values = {path: value for path, _, value in parameters(chosen.form, "friction")}
        return head | {"law": chosen.form.name, "values": values}
    if isinstance(chosen, ChosenLaw):
        head["law"] = chosen.law.name
    else:
        names = [contact.name for contact in rig.mechanism.contacts()]
        head["laws"] = {name: chosen.law.names.get(name) for name in names}
    if chosen.source is not None:
        head["law_file"] = {"file": chosen.source.path, "digest": chosen.source.digest}
        head["remarks"] = list(map(terminal.plain, chosen.remarks))
    return head


def show_heading(rig: Rig, friction: str) -> None:
    """Print which rig was run, and with what."""
    terminal.stdout().print(printable(rig.heading), style="bold", end="")
    terminal.stdout().print(f", {friction}")


def law_to_fit(rig: Rig, name: str | None, kind: AnyKind) -> Law:
    """Return the law to fit, or its name: as asked, the rig's only one, or that of the kind."""
    by_contact = name is not None and "=" in name
    if by_contact and not kind.by_contact:
        raise InputError(
            f"--law {name} names laws by contact, which only records of several joints take: give"
            " one name."
        )
    if kind.by_contact and (by_contact or rig.contacts):
        return _laws_to_fit(rig, name, kind)
    if name is None:
        name = rig.named[0] if len(rig.named) == 1 else kind.usual_law
    _refuse_printed(name)
    if name not in rig.tables and nearest(name, rig.tables) and not nearest(name, listed()):
        raise UnknownNameError(f"law of {rig.path}:", name, rig.tables)
    name = rig.name_of(name)
    return rig.laws.get(name) or name


def _laws_to_fit(rig: Rig, name: str | None, kind: AnyKind) -> dict[str, Law]:
    """Return the law of each contact to fit, or its name, None where nothing rubs."""
    contacts = tuple(contact.name for contact in rig.mechanism.contacts())
    names = names_by_contact(name) if name is not None and "=" in name else {}
    for contact in names:
        if contact not in contacts:
            raise UnknownNameError("contact in --law", contact, contacts)
    result: dict[str, Law] = {}
    for contact in contacts:
        known = rig.contacts.get(contact, KnownLaws()) or KnownLaws(named=("none",))
        only = known.named[0] if len(known.named) == 1 else kind.usual_law
        key = known.name_of(names.get(contact) or (only if names or name is None else name))
        result[contact] = None if key == "none" else known.laws.get(key) or key
    return result


def names_by_contact(text: str) -> dict[str, str]:
    """Return names of laws by contact, as in ``front=coulomb,rear=dahl``.

    Examples
    --------
    >>> names_by_contact("front=coulomb, rear=dahl")
    {'front': 'coulomb', 'rear': 'dahl'}
    """
    pairs = [tuple(map(str.strip, part.partition("="))) for part in text.split(",")]
    result = {contact: law for contact, _, law in pairs if law}
    if len(result) < len(pairs):
        raise InputError(f"--law takes one law of each contact, as in front=coulomb, got {text!r}.")
    return result


def rig_with(
    options: option_groups.RigOptions, given: Mapping[str, str], *, law: str | None = None
) -> Rig:
    """Return the rig of a file under overrides; an unknown one is told what the law at hand has."""
    path, allow_import = options.rig, options.allow_import
    try:
        return load_rig(path, overrides=given, allow_import=allow_import)
    except UnknownNameError as error:
        key = next(
            (item for item in given if item in (error.name, f"{FRICTION}{error.name}")), None
        )
        if key is None or not error.kind.startswith("key"):
            raise
        rig = load_rig(path, allow_import=allow_import)
        known = {} if key.startswith(FRICTION) else all_paths(rig.mechanism, "mechanism")
        names = [*rig.named] if law is None else [law] if law in listed() else []
        for name in names:
            known |= {f"{FRICTION}{label}": x for label, x in fields_of(law_type(name)).items()}
        ends = [full for full in known if full.rpartition(".")[2] == error.name]
        if len(ends) == 1:  # a parameter with a default, which no line of the file names
            again = {ends[0] if label == key else label: value for label, value in given.items()}
            return load_rig(path, overrides=again, allow_import=allow_import)
        if ends:
            raise InputError(
                f"--set {key}: several paths end so, {joined(ends)}: give one of them."
            ) from None
        # as the last names that --set takes, of which an earlier path has the symbol
        symbols = {full.rpartition(".")[2]: x.symbol for full, x in reversed(known.items())}
        of = f" of {joined(names)}" if key.startswith(FRICTION) and names else ""
        own = UnknownNameError(f"parameter{of} in --set:", error.name, symbols, symbols)
        if "Did you mean" in str(error) and "Did you mean" not in str(own):
            raise
        raise own from None


def rig_and_friction(options: option_groups.LawOptions) -> tuple[Rig, ChosenLaw | ChosenLaws]:
    """Return the rig and its friction: laws of its contacts, or one."""
    if options.law is None or not FILE.fullmatch(options.law):
        rig = rig_with(options, terminal.overrides(options.changes), law=options.law)
        if rig.contacts:
            laws = _by_contact(rig, options)
            known = estimates_by_contact(rig, laws)
            return rig, ChosenLaws(carried=_of_file(rig, laws, known))
        if options.law is not None and "=" in options.law:
            raise InputError(
                f"--law {options.law} names laws by contact, but {rig.path} has no tables of"
                " contacts: give one name."
            )
    return _rig_and_law(options)


def _by_contact(rig: Rig, options: option_groups.LawOptions) -> Laws:
    """Return the laws of a rig whose contacts have tables of their own."""
    text = options.law
    if options.law_load is not None:
        raise InputError("--law-load applies only to a law from a file, such as --law law.toml.")
    names: str | dict[str, str] | None = text
    if text is not None and "=" in text:
        names = names_by_contact(text)
    laws = assigned(tuple(rig.contacts), rig.law_by_contact(names))
    assert isinstance(laws, Laws)  # of several contacts
    _check_all_used(rig.overridden, laws)
    return laws


def _check_all_used(given: Collection[str], laws: Laws) -> None:
    """Refuse overrides of friction that the law of a contact does not have."""
    for contact, law in laws.members:
        prefix = f"{FRICTION}{contact}."
        own = [path for path in given if path.startswith(prefix)]
        _check_used([FRICTION + path.removeprefix(prefix) for path in own], law, contact)


def _rig_and_law(options: option_groups.LawOptions) -> tuple[Rig, ChosenLaw | ChosenLaws]:
    """Return the rig and its law; where that is from another file, so are overrides of friction."""
    given, law, allow_import = (
        terminal.overrides(options.changes),
        options.law,
        options.allow_import,
    )
    file = None if law is None else FILE.fullmatch(law)
    if file is None and law is not None and law.lower().endswith(OTHER_FILES):
        beside = Path(law).with_name("law.toml")
        raise InputError(
            f"--law takes the name of a law or a .toml file with a law, got {law}: give the"
            f" law.toml that `stickslip select` writes beside its verdict.json, as --law {beside}."
        )
    if file is None:
        if options.law_load is not None:
            raise InputError(
                "--law-load applies only to a law from a file, such as --law law.toml, whose"
                " levels are forces: leave it out."
            )
        rig = rig_with(options, given, law=law)
        chosen = _own(rig, law)
        _check_used(rig.overridden, chosen.law)
        return rig, chosen
    own = {key: value for key, value in given.items() if key.startswith(FRICTION)}
    others = {key: value for key, value in given.items() if key not in own}
    rig = rig_with(options, others)
    check_named(Path(file["path"]))
    if len(rig.mechanism.contacts()) > 1:
        source = load_rig(file["path"], overrides=own, allow_import=allow_import)
        laws = carried_by_contact(source, rig.mechanism, names=file["law"])
        _check_all_used(source.overridden, laws.law)
        if options.law_load is not None:
            raise InputError("--law-load applies to the law of one contact: leave it out.")
        for remark in laws.remarks:
            terminal.note(terminal.plain(remark))
        return rig, ChosenLaws(carried=laws, source=source)
    source = load_rig(file["path"], allow_import=allow_import)
    load = terminal.with_unit("--law-load", options.law_load, LOAD)
    result = carried(source, rig.mechanism, law=file["law"], load=load)
    if own:
        name = result.law.name
        changed = {_of(name, key): value for key, value in own.items()}
        source = load_rig(file["path"], overrides=changed, allow_import=allow_import)
        result = carried(source, rig.mechanism, law=name, load=load)
    for remark in result.remarks:
        terminal.note(terminal.plain(remark))
    return rig, ChosenLaw(carried=result, source=source)


def laws_drawn(
    rig: Rig, chosen: ChosenLaw | ChosenLaws, law_load: str | None, count: int, seed: int
) -> tuple[list[FrictionLaw], float]:
    """Return laws for an ensemble, and by how much mean velocities are off beside them [m/s].

    They are those that a selection drew beside its law file; of another file, draws of the
    parameters of its law from their estimates.
    """
    if not isinstance(chosen, ChosenLaw):
        raise InputError("--ensemble draws the law of one contact: leave it out.")
    source, known = chosen.source, chosen.estimates
    drawn = None if source is None or source.overridden else drawn_laws(source.path)
    if drawn is not None and source is not None:
        laws, error = drawn
        if count > len(laws):
            raise InputError(f"--ensemble takes up to {len(laws)} laws, as {source.path} has.")
        load = terminal.with_unit("--law-load", law_load, LOAD)
        levels = source.estimates and source.estimates.levels
        own = [
            dataclasses.replace(
                source,
                laws={law.name: law},
                named=(law.name,),
                estimates=LawEstimates(law=law.name, levels=levels) if levels else None,
            )
            for law in laws[:count]
        ]
        return [carried(part, rig.mechanism, load=load).law for part in own], error
    if known is None:
        raise InputError(
            "--ensemble needs laws to draw: give the law.toml that `stickslip select` writes as"
            " --law, or a law with estimates."
        )
    terminal.note(
        "No laws were drawn for this law file as it stands: parameters follow their estimates."
    )
    values = known.draw(chosen.law, count, seed=seed)
    rows = zip(*(column.tolist() for column in values.values()), strict=True)
    return [vary(chosen.law, "friction", dict(zip(values, row, strict=True))) for row in rows], 0.0


def _of(law: str, key: str) -> str:
    """Return an override of the law's own table, where it names a value alone."""
    rest = key.removeprefix(FRICTION)
    return key if "." in rest else f"{FRICTION}{law}.{rest}"


def check_named(file: Path) -> None:
    """Refuse the law of a selection that named none, with what to do next."""
    if file.name == "law.toml" and not file.exists() and file.with_name("verdict.json").exists():
        raise InputError(
            f"{file} does not exist: select recommended no law for those data. Follow 'Measure"
            " next' of its report, or fit a law of your own choice with `stickslip fit FILE --law"
            " NAME -o law.toml` and give that file."
        )


def _check_used(given: Collection[str], law: FrictionLaw, contact: str = "") -> None:
    """Refuse overrides of friction that the law of the run, or of a contact, does not have."""
    prefix = f"{FRICTION}{contact}." if contact else FRICTION
    choice = f"{contact}=" if contact else ""
    run = f"the contact {contact!r}" if contact else "the run"
    known = [field.name for field in dataclasses.fields(law)]
    for path in given:
        if not path.startswith(FRICTION):
            continue
        table, dot, _ = path.removeprefix(FRICTION).partition(".")
        if dot and table != law.name:
            raise InputError(
                f"--set {prefix}{path.removeprefix(FRICTION)} sets a parameter of {table}, but"
                f" {run} uses {law.name}: add --law {choice}{table}, or leave it out."
            )
        if not dot and table not in known:
            raise InputError(
                f"--set {prefix}{table} names no parameter of {law.name}, the law of"
                f" {run if contact else 'this run'}, which has {', '.join(known)}. Name another law"
                " with --law, or leave it out."
            )


def _own(rig: Rig, name: str | None) -> ChosenLaw:
    """Return a law of the rig, or one with plain values where the rig does not have it."""
    name = _name(rig) if name is None else rig.name_of(name)
    _refuse_printed(name)
    if name in rig.laws:
        return ChosenLaw(carried=_of_file(rig, rig.laws[name], rig.estimates_of(name)))
    given = rig.given.get(name, {})
    try:
        kind = law_type(name)
    except UnknownNameError as error:
        raise UnknownNameError(
            f"{error.kind}, of the package or of {rig.path}:", name, {*error.known, *rig.tables}
        ) from None
    try:
        law = dataclasses.replace(fits.starting_law(kind), **given)
    except ParameterError as error:
        raise ParameterError(
            f"{rig.path} gives only some parameters of {name}, and they are inconsistent with the"
            f" default values of the others: {error} Give all of them."
        ) from None
    lacks = "only some values" if given else "no values"
    terminal.note(f"{rig.path} has {lacks} for {name}; default values are used: {law}.")
    return ChosenLaw(carried=_of_file(rig, law, rig.estimates_of(name, law)))


def _refuse_printed(name: str) -> None:
    """Refuse an equation as printed where only laws can be taken."""
    if name in PRINTED_FORMS:
        raise InputError(
            f"{name} is an equation as printed, which has no exact solution and is not fitted: only"
            f" `stickslip simulate --law {name} --fixed-step SECONDS` runs it. Its corrected law is"
            f" {PRINTED_FORMS[name].corrected.name}."
        )


def _of_file(rig: Rig, law: Friction, estimates: LawEstimates | None) -> CarriedLaw[Friction]:
    """Return a law, or laws by contact, on the mechanism of its own file."""
    return CarriedLaw(
        law=law, estimates=estimates, remarks=(), source=rig.path, fitted_on=rig.mechanism
    )


def _name(rig: Rig) -> str:
    """Return the law that a rig means: the only one it has, or the usual one of several."""
    for known in (rig.named, tuple(rig.laws)):
        if len(known) == 1:
            return known[0]
    if rig.laws and USUAL_LAW not in rig.laws:
        raise InputError(
            f"{rig.path} has values for several laws, {', '.join(rig.laws)}: choose one with --law."
        )
    if rig.laws:
        others = ", ".join(name for name in rig.laws if name != USUAL_LAW)
        terminal.note(
            f"{rig.path} has values for several laws; {USUAL_LAW} is used. --law chooses {others}."
        )
    return USUAL_LAW


# What `select` and `fit` share: what was measured, how it is fitted, what is to be said of it.


def measured(
    rig: Rig, options: option_groups.MeasuredOptions, *, law: Callable[[AnyKind], Law] | None = None
) -> tuple[AnyKind, Request, list[Path]]:
    """Return what fits such a measurement, what it is asked, and the data files of the options.

    Options for files add to what the rig says of its own. `law` returns the law of a kind.
    """
    settings, validate = options.settings, options.validate
    data, route, reading = options.data, options.route, terminal.reading_of(options)
    if settings.get("hold") not in (None, "zero", "first"):
        raise InputError(f"--hold must be zero or first, got {settings['hold']!r}.")
    own = rig.reading.with_changes(reading)
    measurement, second = rig.measurement, rig.validate
    if data:
        measurement = rig.with_uncertainties(read_data(data, own, mechanism=rig.mechanism))
    elif reading != Reading() and validate is None:
        raise InputError(
            "--columns, --rate, --unit, --gain, --repair and --conditions apply to the files of"
            " --data or --validate: name one, or leave them out."
        )
    if measurement is None:
        raise InputError(
            f"{rig.path} has no measurement: add a [[trial]] with a travel or [data] with a file,"
            " or give --data FILE."
        )
    files = _hashed(data)
    if validate is not None:
        # a second record is predicted, whatever its conditions
        second = read_data([validate], replace(own, conditions=()), mechanism=rig.mechanism)
        files += _hashed([validate])
    measurement = as_judged(measurement, route)
    kind = kind_of(measurement, route)
    chosen = None if law is None else law(kind)
    owner = None if chosen is None else kind.owner(chosen)
    varied, held = _parameters(rig, options.vary, options.fixed, owner)
    numerics = fits.RecordSettings(**{"hold": rig.hold, **settings})
    request = Request(
        mechanism=rig.mechanism,
        measurement=measurement,
        law=owner,
        vary=varied,
        fixed=held,
        route=route,
        settings=None if numerics == fits.RecordSettings() else numerics,
        validate=second,
        assumed=rig.assumed or None,
        t_end=rig.t_end,
    ).only(kind.uses)
    given = {"route": route, **settings, "validate": validate}
    typed = {
        name: f"--{name.replace('_', '-')}" for name, item in given.items() if item is not None
    }
    if rig.hold is not None:
        typed.setdefault("hold", f"hold in [data] of {rig.path}")
    refuse_unused(kind, typed, request)
    if options.rig is None and "t_end" not in kind.uses:  # the bundled rig is a block with a travel
        raise InputError(
            "a record needs a rig file with a mechanism: give one with a [mechanism] table, such"
            ' as type = "axis" and inertia = { value = "80 kg", vary = true }.'
        )
    request = replace(kind.resolved(request), law=chosen)
    refuse_unused(kind, {name: how for name, how in typed.items() if name != "validate"}, request)
    return kind, request, files


def _hashed(given: Sequence[Path]) -> list[Path]:
    """Return the files that hold the data of options."""
    if not given:
        return []
    from stickslip.data import log_files  # with pandas, which other rigs do without

    return [log_file for path in given for log_file in log_files(path)]


def _parameters(
    rig: Rig, vary: Sequence[str], fixes: Sequence[str], law: fits.AnyLaw
) -> tuple[tuple[str, ...], dict[str, float]]:
    """Return what is varied and what fixed, with what the rig file says of both.

    Values that it gives of a law, but not all, are held where `--vary` says what is fitted of it.
    """
    names = [part.strip() for text in vary for part in text.split(",")]
    fixed = _fixed(rig, fixes, law)
    given: Mapping[str, float] = {}
    if isinstance(law, type) and issubclass(law, FrictionLaw):
        given = rig.given.get(law.name, {})
    if given and (not names or fits.LAW in names):
        said = ", ".join(f"{name} = {number(value, 6)}" for name, value in given.items())
        terminal.note(
            f"All parameters of {law.name if law else 'the law'} are fitted, including {said} of"
            " the rig file; --vary adds parameters to the fit, --fixed holds them."
        )
    elif given:
        paths = {f"friction.{name}": value for name, value in given.items()}
        held = {p: v for p, v in paths.items() if not any(fits.covers(name, p) for name in names)}
        fixed = held | fixed
    marked = (path for path in rig.vary if path not in fixed)
    return (*(names or (fits.LAW,)), *marked), fixed


def _fixed(rig: Rig, texts: Sequence[str], law: fits.AnyLaw) -> dict[str, float]:
    """Return fixed values by path, read with their units."""
    known = {**_law_quantities(law), **all_paths(rig.mechanism, "mechanism")}
    result: dict[str, float] = {}
    for part in (part for text in texts for part in text.split(",")):
        name, value = terminal.pair_of(
            part, "--fixed takes NAME=VALUE such as viscous_coefficient=0.4"
        )
        if law is None:
            fits.refuse_of_laws([name], known)
        path = full_path(name, known, "parameter in --fixed")
        with concerning(f"--fixed {path}"):
            result[path] = terminal.number_of(value, known[path])
    return result


def _law_quantities(law: Any) -> Mapping[str, Quantity]:
    """Return the parameters of a law by path, or those of laws by contact."""
    if not isinstance(law, Mapping):
        return fits.law_quantities(law)
    return {
        path.replace("friction.", f"friction.{contact}.", 1): quantity
        for contact, friction in law.items()
        for path, quantity in fits.law_quantities(
            specification(friction).law if isinstance(friction, str) else friction
        ).items()
    }


@contextmanager
def watching(
    names: Sequence[str], kind: AnyKind, request: Request
) -> Iterator[Watching | Searching]:
    """Show how far the fits of laws are; where searches can be ended early, Ctrl-C does so."""
    if kind.counts_runs:
        with Watching(names, "Fitting") as counting:
            yield counting
        return

    def text(error: float) -> str:
        return kind.residual_text(error, request)

    with Interrupts() as interrupts, Searching(names, text, interrupts) as bar:
        yield bar


def show_warnings(checks: Checks) -> None:
    """Print what is doubtful about records, and once what is of several trials."""
    for finding in grouped(checks.findings):
        if finding.severity == "warning":
            terminal.stdout().print(f"! {finding}", style="yellow")


def show_estimates(estimates: Sequence[fits.Estimate]) -> None:
    """Print parameters with their intervals, and why one is not bounded."""
    rows = [
        [
            parameter.words if parameter.quantity.unit in fits.FORCES else parameter.path,
            parameter.quantity.symbol,
            within(parameter.value, parameter.low, parameter.high),
            unit_text(parameter.quantity.unit),
            parameter.range,
        ]
        for parameter in estimates
    ]
    kinds = ", ".join(dict.fromkeys(parameter.interval for parameter in estimates))
    heads = ["parameter", "", "value", "unit", f"range ({kinds})"]
    terminal.show_table("", heads, rows, whole=heads[1:])
    for estimate in estimates:
        if estimate.reason:
            terminal.stdout().print(f"  {estimate.path}: {terminal.plain(estimate.reason)}")


def show_open(words: Wording) -> None:
    """Print what the data cannot tell and what to measure next."""
    console = terminal.stdout()
    for title, lines in (("Limitations", words.cannot_tell), ("Measure next", words.measure_next)):
        if lines:
            console.print(f"\n{title}", style="bold")
        for line in lines:
            console.print(f"  {terminal.plain(line)}")
