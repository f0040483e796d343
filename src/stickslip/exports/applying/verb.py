"""Writes friction of laws into joints of a model file, and says what that leaves of them."""

import os
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip import mechanisms
from stickslip.data import Rig
from stickslip.errors import InputError, UnknownNameError
from stickslip.exports.applying.consumers import read_model
from stickslip.exports.applying.models import Beside, Carried, Model, ModelJoint, Wishes
from stickslip.exports.program import Subject
from stickslip.exports.verb import Usage, evaluated, law_or_rig, subject_of
from stickslip.friction import FrictionLaw
from stickslip.quantities import Given, turned
from stickslip.show.described import Described
from stickslip.show.documents import write_file
from stickslip.show.formatting import joined, quantity

if TYPE_CHECKING:
    from stickslip.exports.verb import Source


@dataclass(frozen=True, kw_only=True)
class AppliedJoint(metaclass=Described):
    """A joint with its new friction, and what that leaves of the law."""

    joint: str
    """Name of the joint in the file."""
    contact: str
    """Whose law it has, where contacts have laws of their own."""
    law: str
    """Name of the law."""
    before: Mapping[str, str]
    """Attributes that the file gave it."""
    after: Mapping[str, str]
    """Attributes that were written."""
    largest_speed: float | None
    """End of the range of speeds over which both are compared [m/s] or [rad/s]; None where the file
    has the law itself."""
    rms: float
    """Root mean square of the difference of the steady friction, over speeds from 0 to the end of
    the range in both directions, all alike [N] or [N m]."""
    largest: float
    """Largest difference there [N] or [N m]."""
    rotary: bool
    """Whether it turns."""
    lost: tuple[str, ...]
    """What the file cannot have of the law, in sentences."""

    @property
    def sentences(self) -> tuple[str, ...]:
        """Attributes, error of the friction and what is lost, in words."""
        unit, speed = turned("N", self.rotary), turned("m/s", self.rotary)
        values = " ".join(f'{key}="{value}"' for key, value in self.after.items())
        before = " ".join(f'{key}="{value}"' for key, value in self.before.items())
        error = (
            "The file has the law itself: the error of the friction is 0."
            if self.largest_speed is None
            else f"Error of the friction up to {quantity(self.largest_speed, speed)}:"
            f" {quantity(self.rms, unit)} rms, {quantity(self.largest, unit)} at most."
        )
        return (f"{values}; before: {before or 'none'}.", error, *self.lost)

    def to_dict(self) -> Mapping[str, Any]:
        """Return the joint as plain values."""
        return {
            "joint": self.joint,
            "contact": self.contact,
            "law": self.law,
            "before": dict(self.before),
            "after": dict(self.after),
            "largest_speed": self.largest_speed,
            "rms": self.rms,
            "largest": self.largest,
            "unit": turned("N", self.rotary),
            "lost": list(self.lost),
        }


@dataclass(frozen=True, kw_only=True, repr=False)
class Applied(metaclass=Described):
    """A model file with friction; made by `apply`."""

    path: Path
    """The file that was read."""
    target: str
    """What reads it, such as ``"urdf"`` or ``"mjcf"``."""
    content: bytes
    """The file with friction, equal to the one that was read but for the joints' attributes."""
    joints: tuple[AppliedJoint, ...]
    """What was written, joint by joint."""
    remarks: tuple[str, ...] = ()
    """What concerns the file as a whole, in sentences."""

    def save(self, path: str | Path, *, force: bool = False) -> Path:
        """Write the file, whole or not at all.

        Parameters
        ----------
        path : str or Path
            Where to; its folder is made if needed.
        force : bool
            Whether a file may be replaced, such as the one that was read.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        InputError
            If there is such a file, or it cannot be written.
        """
        check_output(self.path, Path(path), force=force)
        write_file(Path(path), self.content)
        return Path(path)

    def to_dict(self) -> Mapping[str, Any]:
        """Return what was written as plain values."""
        return {
            "target": self.target,
            "input": str(self.path),
            "joints": [joint.to_dict() for joint in self.joints],
            "remarks": list(self.remarks),
        }

    def __repr__(self) -> str:
        return f"<Applied {self.target}: {', '.join(joint.joint for joint in self.joints)}>"


def check_output(source: Path, path: Path, *, force: bool) -> None:
    """Refuse to replace a file, before any work."""
    if path.is_dir():
        raise InputError(f"{path} is a folder, but a file is written: give its name.")
    if force or not os.path.lexists(path):
        return
    same = source.exists() and path.exists() and path.samefile(source)
    what = "is the file that is read" if same else "already exists"
    raise InputError(
        f"{path} {what}; give --force (in Python force=True) to replace it, or another -o."
    )


def apply(
    source: "Source",
    file: str | Path,
    *,
    joints: str | Collection[str] | Mapping[str, str] | None = None,
    law: str | None = None,
    load: float | None = None,
    largest_speed: Given | None = None,
    law_load: float | None = None,
    at: Mapping[str, Given | Mapping[str, Given]] | None = None,
    to: str | None = None,
    polynomial: bool = False,
    holds: bool = False,
) -> Applied:
    """Write friction laws into the joints of a model file, and change nothing else in it.

    Files are URDF, MJCF, USD as text for PhysX (Isaac Sim) or Newton, the parameters of a servo in
    Rhoban/bam's JSON, and parameters of ROS 2 controllers in YAML. The level and the damping of a
    joint are those that come closest to the law, by least squares over speeds up to the largest in
    both directions; a damper of the law's mechanism is added.

    Parameters
    ----------
    source : FrictionLaw, Fit, Verdict or Rig
        The law, or what has it: of a verdict it is the law to use. `load_rig` reads a ``law.toml``.
        Contacts with laws of their own go to the joints with their names.
    file : str or Path
        The file with the joints.
    joints : str, collection of str, or mapping of str to str, optional
        Joints that get the law; or, by contact, the joint that gets its law. If not given, all
        contacts with a law, or the only joint of the file.
    law : str, optional
        Which of the laws of a rig.
    load : float, optional
        Normal force [N] at which the joint has its friction, as in `export`.
    largest_speed : float or str, optional
        End of the range of speeds; that of the fit if not given.
    law_load : float, optional
        Normal force [N] at which the law was fitted, if its levels are forces.
    at : mapping of str to float, str or mapping, optional
        Contact inputs of the laws at which the joints have their friction: by name for all laws
        that depend on them, and by contact and name for one.
    to : str, optional
        What reads the file: ``"urdf"``, ``"mjcf"``, ``"physx"``, ``"newton"``, ``"bam"`` or
        ``"ros2"``. Needed for USD only, which PhysX and Newton both read.
    polynomial : bool
        Of MJCF, whether the damping changes with the speed (MuJoCo 3.7 and later). Off by default.
    holds : bool
        Whether the level is that of break-away, so that the joint holds what the law holds. By
        default it is the one that comes closest to the law while sliding.

    Returns
    -------
    Applied
        The file with friction, and what it leaves of the laws.

    Raises
    ------
    InputError
        If the file cannot be read, has no such joint, or the joint does not take the law.

    Examples
    --------
    >>> from importlib.resources import files
    >>> from stickslip import CoulombViscous
    >>> arm = files("stickslip.mechanisms") / "desk_arm.urdf"
    >>> law = CoulombViscous(kinetic_coefficient=0.3, viscous_coefficient=0.1)
    >>> found = apply(law, arm, joints="elbow", largest_speed=2.0)
    >>> found.joints[0].sentences[0]
    'damping="0.1" friction="0.3"; before: friction="0.15" damping="0.02".'
    """
    model = read_model(Path(file), to)
    wishes = Wishes(polynomial=polynomial, holds=holds)
    _check_wishes(model, wishes)
    given = Usage(law=law, load=load, largest_speed=largest_speed, law_load=law_load)
    rows: dict[str, AppliedJoint] = {}
    values: list[tuple[ModelJoint, Mapping[str, str]]] = []
    source = law_or_rig(source)
    by_contact = source.contacts.items() if isinstance(source, Rig) else ()
    pairs = _pairs([name for name, known in by_contact if known is not None], model, joints)
    shared, own = _stated(at or {}, [contact for contact, _ in pairs])
    unasked = dict(shared)
    for contact, name in pairs:
        joint = model.joint(name)
        if name in rows:
            raise InputError(f"joint {name!r} is named twice; it has one friction.")
        usage = replace(given, contact=contact or None)
        if isinstance(source, FrictionLaw):
            usage = replace(usage, rotary=joint.rotary is not False)
        whole = subject_of(source, model.title, usage, evaluates=False, rig=None)
        # of several laws, each takes what it depends on
        known = {k: x for k, x in shared.items() if len(pairs) == 1 or k in whole.law.inputs}
        unasked = {k: x for k, x in unasked.items() if k not in known}
        stated = {**known, **own.get(contact, {})}
        exact = not stated and model.has_exactly(whole)
        subject = whole if exact else evaluated(whole, model.title, stated)
        _check_kind(model, joint, subject)
        beside = _beside(subject.mechanism, subject.contact)
        carried = model.carry(joint, subject, beside, wishes)
        values.append((joint, carried.values))
        rows[name] = _applied(joint, contact, subject, carried)
    if unasked:
        raise InputError(f"no law of these joints depends on {joined(list(unasked))}.")
    return Applied(
        path=Path(file),
        target=model.name,
        content=model.written(values),
        joints=tuple(rows.values()),
        remarks=tuple(model.remarks()),
    )


def _check_wishes(model: Model, wishes: Wishes) -> None:
    for name, instead in model.refuses.items():
        if getattr(wishes, name):
            raise InputError(f"{model.title} {instead}: leave {name} (--{name}) out.")


def _pairs(
    contacts: Sequence[str], model: Model, joints: str | Collection[str] | Mapping[str, str] | None
) -> list[tuple[str, str]]:
    """Return contacts and the joints that get their laws; without contacts, empty names."""
    chosen = [joints] if isinstance(joints, str) else joints
    if chosen is not None and not chosen:
        raise InputError("joints is empty: leave it out, or name at least one.")
    if not contacts:
        if isinstance(chosen, Mapping):
            raise InputError(
                f"this is one law and not laws by contact, so there is no"
                f" {', '.join(map(repr, chosen))}: name joints alone."
            )
        names = model.movable if chosen is None else list(chosen)
        if chosen is None and len(names) != 1:
            raise InputError(
                f"{model.path} has {len(names)} joints that take friction"
                f" ({', '.join(names) or 'none with a name'}), and this is one law: choose with"
                " --joint (in Python joints)."
            )
        return [("", name) for name in names]
    if isinstance(chosen, Mapping):
        pairs = dict(chosen)
    else:
        wanted = model.movable if chosen is None else list(chosen)
        pairs = {contact: name for name in wanted for contact in contacts if _same(contact, name)}
        missing = [name for name in chosen or () if name not in pairs.values()]
        if missing:
            raise InputError(
                f"no contact has the name of the joint {missing[0]!r}; contacts with a law:"
                f" {', '.join(contacts)}. Pair them, as --joint {contacts[0]}={missing[0]}"
                f" (in Python joints={{{contacts[0]!r}: {missing[0]!r}}})."
            )
        if chosen is None:
            for contact in contacts:
                pairs.setdefault(contact, contact)  # refused with the names of the joints
    for contact in pairs:
        if contact not in contacts:
            raise InputError(
                f"no contact {contact!r} has a law; those that do: {', '.join(contacts)}."
            )
    return list(pairs.items())


def _same(contact: str, joint: str) -> bool:
    """Return whether a contact has the name of a joint, as robots give it to theirs."""
    if contact == joint:
        return True
    try:
        return mechanisms.RobotJoint(joint=joint, mass=1.0).contact_name == contact
    except InputError:  # a name without letters
        return False


def _check_kind(model: Model, joint: ModelJoint, subject: Subject) -> None:
    if joint.rotary is not None and subject.rotary != joint.rotary:
        what = "turns" if joint.rotary else "slides"
        raise InputError(
            f"{model.path}: joint {joint.name!r} {what}, but the law is of a mechanism that"
            f" {'turns' if subject.rotary else 'slides'}, with friction in"
            f" {turned('N', subject.rotary)}: choose another joint; of an axis, rotary in"
            " [mechanism] says which it is."
        )


def _beside(mechanism: mechanisms.Mechanism | None, contact: str) -> Beside:
    """Return the damper, the motor and its inertia at a joint."""
    if isinstance(mechanism, mechanisms.Axis | mechanisms.Pendulum):
        motor = mechanism.drive if isinstance(mechanism.drive, mechanisms.DCMotor) else None
        inertia = float(mechanisms.driving_inertia(mechanism.drive))
        return Beside(damping=mechanism.damping, armature=inertia or None, motor=motor)
    if isinstance(mechanism, mechanisms.Robot):
        for joint in mechanism.joints:
            if contact in ("", joint.contact_name):
                if joint.coupling:
                    raise InputError(
                        f"friction of {joint.joint!r} acts along a motor that other joints turn too"
                        " (coupling), and that of a joint in a file along its own angle: choose the"
                        " other joints with --joint."
                    )
                inertia = max(0.0, joint.armature + joint.added_armature)
                return Beside(damping=joint.damping, armature=inertia or None)
    if isinstance(mechanism, mechanisms.SerialArm):
        names = [place.name for place in mechanism.contacts()]
        link = mechanism.links[names.index(contact) if contact else 0]
        inertia = link.rotor_inertia * link.gear_ratio**2
        return Beside(damping=link.damping, armature=inertia or None)
    return Beside()


def _stated(
    at: Mapping[str, Given | Mapping[str, Given]], contacts: Sequence[str]
) -> tuple[dict[str, Given], dict[str, Mapping[str, Given]]]:
    """Return contact inputs that are stated for all laws, and those for the law of a contact."""
    shared: dict[str, Given] = {}
    own: dict[str, Mapping[str, Given]] = {}
    for name, value in at.items():
        if not isinstance(value, Mapping):
            shared[name] = value
        elif name in contacts:
            own[name] = value
        else:
            raise UnknownNameError(
                "contact with inputs of its own", name, [*filter(None, contacts)]
            )
    return shared, own


def _applied(joint: ModelJoint, contact: str, subject: Subject, carried: Carried) -> AppliedJoint:
    near = carried.near
    return AppliedJoint(
        joint=joint.name,
        contact=contact,
        law=subject.law.name,
        before=joint.has,
        after=carried.values,
        largest_speed=None if near is None else near.largest_speed,
        rms=0.0 if near is None else near.rms,
        largest=0.0 if near is None else near.largest,
        rotary=subject.rotary,
        lost=carried.lost,
    )
