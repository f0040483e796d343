"""What was measured: one record, or several trials of one rig; and lines of motion in pictures.

Columns are arrays of SI numbers by their quantity. A body followed in a picture has two
coordinates: it moved along the line of least squares through them, and its position is its way
along that line.
"""

import math
import numbers
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from stickslip.data.tolerances import HALF, ROUNDED
from stickslip.data.units import LARGEST_NUMBER, size_wanted
from stickslip.errors import InputError, ParameterError, UnknownNameError, concerning
from stickslip.mechanisms import Mechanism, slips_by_angle
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS, checked_inputs
from stickslip.quantities import Converted, Given, Numbers, Quantity, has_unit, turned
from stickslip.show.described import Described
from stickslip.show.display import InPanels, Summary, Tabular
from stickslip.show.formatting import joined, number, span
from stickslip.units import converted, number_in, pint_magnitude

if TYPE_CHECKING:
    import pandas as pd


# The line along which a body moved in a picture, and its way along that line.

SLENDER: Final = 3.0
"""Spread along a line over that across it from which on the points lie along it."""
SURE: Final = 6.0
"""Standard deviations of the jitter that it must have moved as well."""


@dataclass(frozen=True, kw_only=True)
class Line(metaclass=Described):
    """The line on which positions in a plane were projected, and how far they lay beside it.

    Examples
    --------
    >>> Line(tilt=0.05, length=0.2, across=0.4e-3, jitter=0.4e-3).wander
    0.0
    """

    tilt: float
    """Angle from the first axis of the plane to the line [rad], above -pi/2, at most pi/2."""
    length: float
    """Of the part that the body passed [m]."""
    across: float
    """Distance of the samples from the line, root mean square [m]."""
    jitter: float
    """The part of that distance which changes from one sample to the next [m]."""
    reversed: bool = False
    """Whether the way counts against the first axis of the plane."""

    @property
    def wander(self) -> float:
        """The part of the distance that is no jitter, root mean square [m]."""
        return float(np.sqrt(max(self.across**2 - self.jitter**2, 0.0)))

    def scaled(self, factor: float) -> "Line":
        """Return the line with its lengths times a factor."""
        return replace(
            self,
            length=factor * self.length,
            across=factor * self.across,
            jitter=factor * self.jitter,
        )


def travels(way: NDArray[np.float64]) -> bool:
    """Whether a body is in the end a good part of its whole way from where it began.

    Examples
    --------
    >>> travels(np.array([0.0, -0.1, 0.3, 0.8])), travels(np.array([0.0, 1.0, -1.0, 0.2]))
    (True, False)
    """
    return bool(abs(way[-1] - way[0]) > HALF * np.ptp(way))


def along(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[NDArray[np.float64], Line]:
    """Return the way along the line through points, and that line.

    The line is the principal axis of the points, from which their squared distances are smallest.
    It is positive in the direction of the net travel, since what drives itself may recoil first;
    of a swing, which has none, in that of its first move.

    An error of its angle, about jitter over length and root of n, shortens ways by half its square
    only, so that nothing is gained by measuring the angle.

    Examples
    --------
    >>> position, line = along(np.array([5.0, 1.0, -3.0]), np.array([1.0, 4.0, 7.0]))
    >>> position.tolist(), round(float(np.degrees(line.tilt)), 2)
    ([0.0, 5.0, 10.0], -36.87)
    """
    points = np.stack([x, y], axis=1)
    centred = points - points.mean(axis=0)
    if len(points) < 2:  # which have no axes
        return np.zeros(len(points)), Line(tilt=0.0, length=0.0, across=0.0, jitter=0.0)
    # Rows of `axes` are the unit vectors along and across; `spread` is root of n times the rms.
    _, spread, axes = np.linalg.svd(centred, full_matrices=False)
    long, short = spread / np.sqrt(len(points))
    if not long > SLENDER * short:
        raise InputError(
            "the two columns of position show no motion along a line: their points scatter by"
            f" {number(float(long))} along and {number(float(short))} across the best-fit line"
            " (root mean square). Name a single column, or compute one position or angle from both"
            " first."
        )
    way, beside = centred @ axes.T[:, 0], centred @ axes.T[:, 1]
    way = way - way[0]
    jitter = min(float(np.sqrt(np.mean(np.diff(beside) ** 2) / 2)), float(short))
    length = float(np.ptp(way))
    far = np.abs(way) >= max(ROUNDED * length, min(SURE * jitter, length / 2))
    net = way[-1] if travels(way) else way[int(np.argmax(far))]
    ahead = axes[0, 0] > 0 or (axes[0, 0] == 0 < axes[0, 1])
    cosine, sine = axes[0] if ahead else -axes[0]
    line = Line(
        tilt=float(np.arctan2(sine, cosine)),
        length=length,
        across=float(short),
        jitter=jitter,
        reversed=bool(ahead != (net > 0.0)),
    )
    return way * np.sign(net), line


def plain_conditions(given: object) -> dict[str, float | str]:
    """Return conditions by name as floats and texts.

    Examples
    --------
    >>> plain_conditions({"temperature [degC]": 20, "direction": "up"})
    {'temperature [degC]': 20.0, 'direction': 'up'}
    """
    if not isinstance(given, Mapping):
        raise InputError(f"Measurement.conditions must be a mapping by name, got {given!r}.")
    result: dict[str, float | str] = {}
    for name, value in given.items():
        if isinstance(value, str) and value.strip():
            result[str(name)] = value.strip()
            continue
        real = isinstance(value, numbers.Real) and not isinstance(value, bool)
        if not real or not math.isfinite(float(value)):
            raise ParameterError(
                f"Measurement.conditions of {name!r} must be a finite number or a text, got"
                f" {value!r}: leave an unknown condition out."
            )
        result[str(name)] = float(value)
    return result


def condition_name(full: str) -> str:
    """Return the name of a condition without its unit.

    Examples
    --------
    >>> condition_name("temperature [degC]"), condition_name("direction")
    ('temperature', 'direction')
    """
    return full.partition("[")[0].strip()


def condition_unit(full: str) -> str:
    """Return the unit of a condition, as it stands in brackets after its name.

    Examples
    --------
    >>> condition_unit("temperature [degC]"), condition_unit("run")
    ('degC', '')
    """
    return full.partition("[")[2].partition("]")[0].strip()


Array = NDArray[np.float64]
Kind = Literal["scalars", "series", "friction-map"]
Levels: TypeAlias = Literal["per load", "forces", "torques"]
"""What a law's levels are: over the normal force, or forces or torques where no load is known."""
Uncertainty = Literal["rounding", "standard", "interval"]
Series: TypeAlias = Converted[Numbers | None, Array | None]
Values: TypeAlias = Converted[Given | Numbers | None, Array | float | None]
Moving: TypeAlias = Converted[Given | Numbers | Mapping[str, Numbers] | None, Array | float | None]
"""What may be given by joint; it is then kept in `Measurement.joints`."""
ByInput: TypeAlias = Converted[
    Mapping[str, Given | Numbers | Mapping[str, Given | Numbers]], Mapping[str, Array | float]
]
ByQuantity: TypeAlias = Converted[
    Given | Numbers | Mapping[str, Given | Numbers], Mapping[str, Array | float]
]
# defaults, whose type a type checker need not compare with what is kept
ABSENT: Any = None
NONE_STATED: Any = field(default_factory=dict)
NO_INPUTS: Any = field(default_factory=dict)
NO_TRIALS: Any = ()

KINDS_OF_UNCERTAINTY: tuple[Uncertainty, ...] = ("rounding", "standard", "interval")

TIME = Quantity("t", "s")

QUANTITIES: Mapping[str, Quantity] = MappingProxyType(
    {
        "position": Quantity("x", "m", or_unit="rad"),
        "velocity": Quantity("v", "m/s", or_unit="rad/s"),
        "force": Quantity("u", "N", or_unit="N m"),
        "friction": Quantity("F", "N", or_unit="N m"),
        "load": Quantity("N", "N"),
        "spring_force": Quantity("F_s", "N", or_unit="N m"),
        "pull": Quantity("x_p", "m", or_unit="rad"),
        "reference": Quantity("x_r", "m", or_unit="rad"),
        "voltage": Quantity("u_m", "V"),
        "current": Quantity("i", "A"),
        "travel": Quantity("s", "m"),
        "mean_velocity": Quantity("v_m", "m/s"),
        "travel_per_cycle": Quantity("s_c", "m"),
    }
)
"""What can be measured, by name; the second unit is that of an axis that turns."""

STATED = "friction_uncertainty"
"""Column of a file with the standard uncertainty of each reading of friction."""

ELECTRIC = ("current", "voltage")
"""What drives a motor, and no mechanism without one."""

TRAVELS = ("travel", "mean_velocity", "travel_per_cycle")
"""How it can be given how far a body came; a trial has one of them."""

COMPARED_THEMSELVES = frozenset({*TRAVELS, "friction", "position", "velocity", "force"})
"""Quantities that laws can be compared with, sample by sample."""

SAMPLED = tuple(name for name in QUANTITIES if name not in TRAVELS)
"""What a time series has one value of for each time."""

BESIDE = tuple(name for name in CONTACT_INPUTS if name not in QUANTITIES)
"""Contact inputs that are no such quantity themselves."""

BY_JOINT = ("position", "velocity", "force")
"""What may be given by the name of a joint."""


def is_beside(name: str) -> bool:
    """Whether a column is known by a contact input, that of a joint at its end or not.

    Examples
    --------
    >>> is_beside("temperature.elbow"), is_beside("position.elbow")
    (True, False)
    """
    return name.partition(".")[0] in BESIDE


def quantity_called(name: str) -> Quantity:
    """Return what is measured under a name, that of a joint at its end or not.

    Examples
    --------
    >>> quantity_called("force.elbow").symbol
    'u'
    """
    known, _, joint = name.partition(".")
    if joint and known not in BY_JOINT:
        raise KeyError(name)
    return QUANTITIES[known]


def unit_of_input(name: str, *, turning: bool = False) -> str:
    """Return the unit of a contact input.

    Examples
    --------
    >>> unit_of_input("transmitted", turning=True), unit_of_input("temperature")
    ('N m', 'degC')
    """
    return turned(CONTACT_INPUTS[name].unit, turning)


SENTENCES: Mapping[str, str] = MappingProxyType(
    {
        "series": "Record in time",
        "friction-map": "Friction map",
        "travels": "Travels",
        "scalars": "Single values",
    }
)
"""What a measurement without a name is called, by kind."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Measurement(Tabular, InPanels):
    """One record, or several trials of one rig.

    Arrays are copied and made read-only; scalars become floats.

    Parameters
    ----------
    time : array (n,), optional
        Times of the samples [s], increasing.
    position, velocity : array (n,), float or mapping of str to array (n,), optional
        Of the slipping body, [m] and [m/s]. Where several coordinates were measured, such as the
        joints of a robot, by the name of the coordinate; `joints` then has them.
    force : array (n,), float or mapping of str to array (n,), optional
        Applied force [N], or the force along each coordinate, by its name.
    friction : array (n,) or float, optional
        Friction force [N], with the sign of the slip velocity.
    load : array (n,) or float, optional
        Normal force [N]; one number if it stays the same.
    spring_force : array (n,) or float, optional
        Force of the spring that pulls the body [N].
    pull : array (n,) or float, optional
        Position of the far end of that spring [m].
    reference : array (n,) or float, optional
        Position that a controller was asked for [m].
    voltage : array (n,) or float, optional
        Voltage of the motor that drives the mechanism [V]; of a PWM, duty times supply.
    current : array (n,) or float, optional
        Current of that motor [A].
    travel : float or array (n,), optional
        Distance [m] from the start to the final rest; under a drive that repeats itself, and of a
        cart or capsule that drives itself, to the end of the run. An array is repeats of one run.
    mean_velocity : float or array (n,), optional
        Instead of a travel: the same over the whole run, from 0 to ``t_end``, over ``t_end`` [m/s].
    travel_per_cycle : float or array (n,), optional
        Instead of a travel: way over as many whole cycles of the drives as end by ``t_end``, from
        time 0, over their number [m].
    uncertainty : mapping of str to float or array (n,), optional
        By quantity: a number above 0, or one from 0 for each of its values. Without a mapping, that
        of the only quantity; it is kept as a mapping.
    uncertainty_kind : {"standard", "rounding", "interval"}
        What the uncertainty is: a standard error; half a last digit, so that the true value lies
        within it; or the half width of an interval.
    overrides : mapping of str to float, optional
        What was different in this record, by parameter path.
    parameter_uncertainties : mapping of str to float, optional
        Standard uncertainties of the mechanism's parameters, by path, above 0, which fits to
        travels and records propagate. Those of a trial are its own; those beside trials are shared
        by all of them, but for a parameter that trials override, which was set anew for each.
    conditions : mapping of str to float or str, optional
        What else was different, such as ``{"temperature [degC]": 20, "direction": "up"}``, by name
        with its unit if it has one. A law with an input of that name takes its value.
    inputs : mapping of str to array (n,), float or mapping of str to these, optional
        What laws may ask of the contact beside speed and load, by its name, such as
        ``{"temperature": [20.0, 20.1]}``: a temperature [degC], the torque that a gear transmits.
        Where each joint has its own, by the name of the joint; `joints` then has them.
    initial : mapping of str to float, optional
        Initial states by name; the others are 0, or found where runs of a mechanism that drives
        itself follow its record.
    offset : mapping of str to float, optional
        Offset of a sensor by quantity; `values` subtracts it. That of one joint is called
        ``"force.elbow"``.
    turning : bool
        Whether all that was measured is about an axis: angles [rad], their rates [rad/s], torques
        [N m].
    unused : mapping of str to float, str or None, optional
        Columns of its file that nothing was read from: their value, None if it changes.
    lost : sequence of str, optional
        What its file says that it holds and does not, a sentence each.
    volts : sequence of str, optional
        Forces that were recorded in volts, of which a gain made what they are.
    line : Line, optional
        The line on which positions in a plane were projected.
    name, provenance : str
        What the record is called and where it comes from.
    joints : mapping of str to Measurement, optional
        What was measured of each coordinate, with the same times: made from what is given by joint.
    trials : sequence of Measurement
        Instead of all the above: records of one kind.

    Raises
    ------
    InputError
        If the parts do not make a measurement.

    Examples
    --------
    >>> one = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
    >>> one.kind, one.quantities(), one.uncertainty
    ('scalars', ('travel',), {'travel': 0.005})
    >>> table = Measurement(
    ...     velocity=[0.1, 0.2], friction=[2.5, 2.6], uncertainty={"friction": [0.05, 0.1]}
    ... )
    >>> table.uncertainty["friction"]
    array([0.05, 0.1 ])
    >>> both = Measurement(
    ...     trials=(
    ...         Measurement(travel=0.072, overrides={"mechanism.compression": 0.06}),
    ...         Measurement(travel=0.200, overrides={"mechanism.compression": 0.10}),
    ...     )
    ... )
    >>> [record.travel for record in both.records()]
    [0.072, 0.2]

    The spring is known to 2 N/m, the same in all trials:

    >>> from dataclasses import replace
    >>> replace(both, parameter_uncertainties={"mechanism.stiffness": 2.0}).parameter_uncertainties
    {'mechanism.stiffness': 2.0}

    An arm with two joints:

    >>> arm = Measurement(
    ...     time=[0.0, 0.1],
    ...     position={"shoulder": [0.0, 0.1], "elbow": [0.5, 0.4]},
    ...     force={"shoulder": [0.0, 0.0], "elbow": [0.2, 0.3]},
    ...     turning=True,
    ... )
    >>> arm.quantities()
    ('position.shoulder', 'force.shoulder', 'position.elbow', 'force.elbow')
    >>> arm.joints["elbow"].position, arm.unit("force.elbow")
    (array([0.5, 0.4]), 'N m')
    """

    time: Series = ABSENT
    position: Moving = ABSENT
    velocity: Moving = ABSENT
    force: Moving = ABSENT
    friction: Values = ABSENT
    load: Values = ABSENT
    spring_force: Values = ABSENT
    pull: Values = ABSENT
    reference: Values = ABSENT
    voltage: Values = ABSENT
    current: Values = ABSENT
    travel: Values = ABSENT
    mean_velocity: Values = ABSENT
    travel_per_cycle: Values = ABSENT
    uncertainty: ByQuantity = NONE_STATED
    uncertainty_kind: Uncertainty = "standard"
    overrides: Mapping[str, float] = field(default_factory=dict)
    parameter_uncertainties: Mapping[str, float] = field(default_factory=dict)
    conditions: Mapping[str, float | str] = field(default_factory=dict)
    inputs: ByInput = NO_INPUTS
    initial: Mapping[str, float] = field(default_factory=dict)
    offset: Mapping[str, float] = field(default_factory=dict)
    turning: bool = False
    unused: Mapping[str, float | str | None] = field(default_factory=dict)
    lost: Sequence[str] = ()
    volts: Sequence[str] = ()
    line: Line | None = None
    name: str = ""
    provenance: str = ""
    joints: Mapping[str, "Measurement"] = field(default_factory=dict)
    trials: Converted[Sequence["Measurement"], tuple["Measurement", ...]] = NO_TRIALS

    def __post_init__(self) -> None:
        """Check all parts and keep them as floats, read-only arrays and plain mappings."""
        if self.uncertainty_kind not in KINDS_OF_UNCERTAINTY:
            raise InputError(
                f"Measurement.uncertainty_kind must be one of {', '.join(KINDS_OF_UNCERTAINTY)},"
                f" got {self.uncertainty_kind!r}."
            )
        self._set("trials", tuple(self.trials))
        self._set(
            "parameter_uncertainties",
            _positive("parameter_uncertainties", self.parameter_uncertainties),
        )
        # What is given by joint becomes records of joints, and is then not kept twice.
        joints = _joints(self)
        _check_inputs(self, joints)
        self._set("joints", _with_own_inputs(joints, self))
        for name in BY_JOINT if self.joints else ():
            self._set(name, None)
        for name, quantity in {"time": TIME, **QUANTITIES}.items():
            if getattr(self, name) is not None:
                self._set(name, _numbers(name, quantity, getattr(self, name), self.turning))
        if self.trials:
            _check_trials(self)
            self._set("turning", any(trial.turning for trial in self.trials))
            return
        if not self.quantities():
            raise InputError(
                "A Measurement needs at least one quantity"
                f" ({', '.join(QUANTITIES)}) or trials, got none."
            )
        self._set("inputs", _inputs(self))
        _check_shapes(self)
        self._check_travels()
        self._set("uncertainty", _uncertainty(self))
        self._set("conditions", plain_conditions(self.conditions))
        for name in ("overrides", "initial", "offset"):
            self._set(name, _floats(name, getattr(self, name)))
        for quantity_name in self.offset:
            _present("offset", quantity_name, self.quantities())

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _check_travels(self) -> None:
        given = [name for name in TRAVELS if getattr(self, name) is not None]
        if len(given) > 1:
            raise InputError(
                f"Measurement.{given[0]} and {given[1]} both give the distance travelled: give"
                f" only one of {', '.join(TRAVELS)}."
            )
        for name in given:
            for value in np.atleast_1d(getattr(self, name)):
                _check_size("Measurement", name, float(value), QUANTITIES[name])

    def input_names(self) -> tuple[str, ...]:
        """Return the names of the contact inputs that every record has.

        Examples
        --------
        >>> Measurement(time=[0, 1], force=[2, 3], inputs={"temperature": 20}).input_names()
        ('temperature',)
        """
        result = [
            {name for own in (record, *record.joints.values()) for name in own.contact_inputs()}
            for record in self.records()
        ]
        # In the order of the table of inputs, whatever order records have.
        return tuple(name for name in CONTACT_INPUTS if all(name in own for own in result))

    def contact_inputs(self, joint: str = "") -> dict[str, Array | float]:
        """Return what was measured of `inputs`, or stated as a condition of one of their names.

        Parameters
        ----------
        joint : str
            Joint whose own inputs are added to those that all share; empty for the latter.

        Returns
        -------
        dict of str to array (n,) or float
            Values in SI units, temperatures in degC, by the name of the input.

        Examples
        --------
        >>> Measurement(travel=0.2, conditions={"temperature [K]": 293.15}).contact_inputs()
        {'temperature': 20.0}
        """
        stated = {
            name: converted(value, condition_unit(full) or target, target)
            for full, value in self.conditions.items()
            if (name := condition_name(full)) in CONTACT_INPUTS and isinstance(value, float)
            for target in [unit_of_input(name, turning=self.turning)]
        }
        own = self.joints[joint].inputs if joint in self.joints else {}
        # What was measured goes before what was stated, and a joint's own before what all share.
        return {**stated, **self.inputs, **own}

    @property
    def travelled(self) -> str:
        """Which of travel, mean_velocity and travel_per_cycle was measured; empty if none was.

        That of the first trial that has one.

        Examples
        --------
        >>> Measurement(mean_velocity=0.012).travelled
        'mean_velocity'
        """
        return next((name for name in self.quantities() if name in TRAVELS), "")

    @property
    def content(self) -> str:
        """What laws are compared with; each is a kind of measurement.

        That is the friction of a load point that is pulled only where the motion of the slider was
        not measured: friction is a function of that motion.

        Examples
        --------
        >>> Measurement(time=[0.0, 1.0, 2.0], spring_force=[0.1, 0.2, 0.3]).content
        'spring force'
        >>> pulled = {"time": [0.0, 1.0], "pull": [0.0, 1e-6], "friction": [0.6, 0.6]}
        >>> Measurement(**pulled).content, Measurement(**pulled, velocity=[1e-6, 1e-6]).content
        ('velocity steps', 'records')
        """
        known, records = {*self.quantities()}, self.records()
        if "spring_force" in known and not known & COMPARED_THEMSELVES:
            return "spring force"
        if self.travelled:
            return "travels"
        if self.joint_names():
            return "joints"
        pulled = all({"pull", "friction"} <= {*record.quantities()} for record in records)
        timed = all(record.time is not None for record in records)
        if pulled and timed and not known & {"position", "velocity"}:
            return "velocity steps"
        tables = all(record.kind == "friction-map" for record in records)
        return "tables" if tables else "records"

    @property
    def kind(self) -> Kind:
        """``"series"`` in time, ``"friction-map"`` of force and velocity, or ``"scalars"``."""
        if self.trials:
            return self.trials[0].kind
        if self.time is not None:
            return "series"
        # Friction against velocity without times is a map; single numbers are readings.
        both = isinstance(self.friction, np.ndarray) and isinstance(self.velocity, np.ndarray)
        return "friction-map" if both else "scalars"

    def records(self) -> tuple["Measurement", ...]:
        """Return the trials, or this record alone.

        Examples
        --------
        >>> len(Measurement(travel=0.2).records())
        1
        """
        return self.trials or (self,)

    def quantities(self) -> tuple[str, ...]:
        """Return the names of what was measured, time left out.

        Examples
        --------
        >>> Measurement(velocity=[0.1, 0.2], friction=[2.5, 2.6]).quantities()
        ('velocity', 'friction')
        """
        records = self.records()
        plain = [
            name
            for name in QUANTITIES
            if any(getattr(record, name) is not None for record in records)
        ]
        by_joint = dict.fromkeys(
            f"{name}.{joint}"
            for record in records
            for joint, measured in record.joints.items()
            for name in measured.quantities()
        )
        return (*plain, *by_joint)

    def joint_names(self) -> tuple[str, ...]:
        """Return the names of the joints that were measured; none where nothing is by joint.

        Examples
        --------
        >>> Measurement(travel=0.2).joint_names()
        ()
        """
        return tuple(dict.fromkeys(name for record in self.records() for name in record.joints))

    def unit(self, quantity: str) -> str:
        """Return the SI unit of a quantity: of an angle or torque where the record is `turning`.

        Examples
        --------
        >>> Measurement(velocity=[0.1, 0.2], friction=[2.5, 2.6], turning=True).unit("friction")
        'N m'
        """
        _present("measurement", quantity, (*QUANTITIES, *self.quantities()))
        known = quantity_called(quantity)
        return known.or_unit if self.turning and known.or_unit else known.unit

    def to_dataframe(self) -> "pd.DataFrame":
        """Return what was measured as a pandas DataFrame, as `load_measurement` reads it.

        Times and quantities have their units in brackets, values as measured, with the offsets of
        sensors. Of several trials, a column ``trial`` has the names; travels are a row each.

        Examples
        --------
        >>> list(Measurement(time=[0, 1], force=[2.0, 3.0], turning=True).to_dataframe())
        ['time [s]', 'force [N m]']
        """
        import pandas as pd

        parts = []
        for place, record in enumerate(self.records(), 1):
            columns: dict[str, Any] = {"trial": record.name or place} if self.trials else {}
            columns |= {} if record.time is None else {"time [s]": record.time}
            for name in record.quantities():
                first, _, joint = name.partition(".")
                held = getattr(record.joints[joint] if joint else record, first)
                columns[f"{name} [{record.unit(name)}]"] = held
                doubt = record.uncertainty.get(name)
                if isinstance(doubt, np.ndarray) or (doubt and name == "friction"):
                    stated = "uncertainty" if name in TRAVELS else f"{name}_uncertainty"
                    columns[f"{stated} [{record.unit(name)}]"] = doubt
            for joint, measured in {"": record, **record.joints}.items():
                for name, held in measured.inputs.items():
                    unit = unit_of_input(name, turning=record.turning)
                    columns[f"{name}{joint and '.'}{joint} [{unit}]"] = held
            # A record of single numbers is one row, which pandas wants an index for.
            parts.append(pd.DataFrame(columns, index=None if record._is_long() else [0]))
        return pd.concat(parts, ignore_index=True)

    def _over(self) -> str:
        return "time"

    def _summary(self) -> Summary:
        records = self.records()
        rows: list[tuple[str, object]] = []
        if self.trials:
            rows.append(("trials", len(self.trials)))
        if self.kind != "scalars":
            sizes = [len(record.to_dataframe()) for record in records]
            rows.append(("samples", " + ".join(map(str, sizes)) if len(sizes) < 6 else sum(sizes)))
        times = [record.time for record in records if record.time is not None]
        if times:
            first, last = min(t[0] for t in times), max(t[-1] for t in times)
            rows.append(("time", f"{number(first, 4)} to {number(last, 4)} s"))
        rows += [(name, self._extent(name)) for name in self.quantities()]
        rows += [(name, self._span_of_input(name)) for name in self.input_names()]
        changed = {
            path: {record.overrides[path] for record in records if path in record.overrides}
            for path in dict.fromkeys(path for record in records for path in record.overrides)
        }
        different = dict.fromkeys(name for record in records for name in record.conditions)
        rows += [
            (path, f"{span(min(values), max(values), '1', 4)} [SI]")
            for path, values in changed.items()
        ]
        rows += [("conditions", ", ".join(different))] if different else []
        return Summary(
            sentence=self.name or SENTENCES["travels" if self.travelled else self.kind],
            rows=rows,
            notes=[self.provenance] if self.provenance else [],
        )

    def _extent(self, quantity_name: str) -> str:
        """Return the range of the values of a quantity, with its unit, and its uncertainty."""
        result = [record for record in self.records() if quantity_name in record.quantities()]
        values = np.concatenate([np.atleast_1d(record.values(quantity_name)) for record in result])
        text = span(float(values.min()), float(values.max()), self.unit(quantity_name))
        doubts = {
            span(float(np.min(doubt)), float(np.max(doubt)), self.unit(quantity_name))
            for record in result
            for doubt in [record.uncertainty.get(quantity_name)]
            if doubt is not None
        }
        kind = result[0].uncertainty_kind
        return f"{text}, uncertainty {' or '.join(sorted(doubts))} ({kind})" if doubts else text

    def _span_of_input(self, name: str) -> str:
        """Return the range of a contact input, with its unit."""
        values = [
            np.atleast_1d(own.contact_inputs()[name])
            for record in self.records()
            for own in (record, *record.joints.values())
            if name in own.contact_inputs()
        ]
        low, high = (float(f(np.concatenate(values))) for f in (np.min, np.max))
        return span(low, high, unit_of_input(name, turning=self.turning))

    def _is_long(self) -> bool:
        """Whether there is more than one number of a quantity."""
        held = (getattr(self, name) for name in QUANTITIES)
        return self.time is not None or any(isinstance(value, np.ndarray) for value in held)

    def condition(self, name: str, unit: str) -> float | None:
        """Return a condition in a unit, whatever its own is; None if there is no such number.

        Parameters
        ----------
        name : str
            Its name, without the unit.
        unit : str
            Unit of what is returned, and of a condition noted without one.

        Returns
        -------
        float or None
            The condition.

        Examples
        --------
        >>> Measurement(travel=0.2, conditions={"duration [ms]": 400}).condition("duration", "s")
        0.4
        """
        for full, value in self.conditions.items():
            if condition_name(full) == name and not isinstance(value, str):
                return float(converted(value, condition_unit(full) or unit, unit))
        return None

    def usual_uncertainty(self, quantity: str) -> float:
        """Return the stated uncertainty of a quantity as one number; 0 if none is stated.

        Of uncertainties by reading it is the root mean square.

        Examples
        --------
        >>> Measurement(travel=[0.2, 0.3], uncertainty=[0.003, 0.004]).usual_uncertainty("travel")
        0.0035...
        """
        return float(np.sqrt(np.mean(np.square(self.uncertainty.get(quantity, 0.0)))))

    def values(self, quantity: str) -> Array | float:
        """Return a quantity with its sensor offset subtracted.

        Parameters
        ----------
        quantity : str
            One of `quantities`.

        Returns
        -------
        array (n,) or float
            Corrected values in SI units.

        Raises
        ------
        UnknownNameError
            If this record does not have that quantity.

        Examples
        --------
        >>> Measurement(travel=0.25, offset={"travel": 0.05}).values("travel")
        0.2
        """
        if self.trials:
            raise InputError(
                "The measurement has several trials: take the values of each of"
                " Measurement.records()."
            )
        _present("measurement", quantity, self.quantities())
        name, _, joint = quantity.partition(".")
        if joint:
            return self.joints[joint].values(name)
        value = cast("Array | float", getattr(self, quantity))
        return value - self.offset.get(quantity, 0.0)


def _check_inputs(record: Measurement, joints: Mapping[str, Measurement]) -> None:
    """Refuse inputs that would stand in the place of what was measured."""
    given: Any = record.inputs
    if not isinstance(given, Mapping):
        raise InputError(f"Measurement.inputs must be a mapping by name, got {_short(given)}.")
    for name in filter(QUANTITIES.__contains__, given):
        if joints or isinstance(given[name], Mapping) or getattr(record, name) is not None:
            raise InputError(
                f"Measurement.inputs gives {name}, which is a quantity of the record: give it as"
                f" Measurement.{name} alone."
            )


def _inputs(record: Measurement) -> dict[str, Array | float]:
    """Return contact inputs as floats and arrays (n,), all finite."""
    given: Any = record.inputs
    return {
        name: _numbers(
            f"inputs.{name}",
            CONTACT_INPUTS[name].quantity(unit_of_input(name, turning=record.turning)),
            given[name],
            record.turning,
        )
        for name in checked_inputs(given)
        if not isinstance(given[name], Mapping)  # joints have these
    }


def _with_own_inputs(
    joints: Mapping[str, Measurement], record: Measurement
) -> Mapping[str, Measurement]:
    """Return joints with the contact inputs that are given by joint."""
    given: Any = record.inputs
    tables = {name: value for name, value in given.items() if isinstance(value, Mapping)}
    result = dict(joints)
    for name, table in tables.items():
        for joint, values in table.items():
            if joint not in joints:
                if not joints:
                    raise InputError(
                        f"Measurement.inputs gives {name} by joint, but no position, velocity or"
                        " force is given by joint."
                    )
                raise UnknownNameError(f"joint in Measurement.inputs, {name}:", joint, joints)
            result[joint] = replace(result[joint], inputs={**result[joint].inputs, name: values})
    return result


def _joints(record: Measurement) -> Mapping[str, Measurement]:
    """Return what was measured of each joint as a record of its own, with the same times."""
    given: dict[str, Any] = {
        name: getattr(record, name) for name in BY_JOINT if getattr(record, name) is not None
    }
    tables = {name: table for name, table in given.items() if isinstance(table, Mapping)}
    if not tables:
        return _shared_times(record)
    plain = [name for name in given if name not in tables]
    if plain or record.joints:
        other = f"{plain[0]} is not" if plain else "joints are given too"
        raise InputError(
            f"Measurement.{next(iter(tables))} is given by joint, but {other}: give position,"
            " velocity and force by joint, or none of them."
        )
    names = dict.fromkeys(joint for table in tables.values() for joint in table)
    for joint in names:
        if not isinstance(joint, str) or not joint or "." in joint:
            raise InputError(
                f"the name of a joint must be a text without a dot, such as 'elbow', got {joint!r}."
            )
    given_offset: Any = record.offset  # checked later
    offsets = given_offset if isinstance(given_offset, Mapping) else {}
    result = {}
    for joint in names:
        own = {name: table[joint] for name, table in tables.items() if joint in table}
        offset = {
            name.partition(".")[0]: value
            for name, value in offsets.items()
            if str(name).partition(".")[2] == joint
        }
        with concerning(f"joint {joint!r}:", InputError):
            result[joint] = Measurement(
                time=record.time, **own, offset=offset, turning=record.turning, name=joint
            )
    return result


def _shared_times(record: Measurement) -> Mapping[str, Measurement]:
    """Return joints that were made before, which must have the times of their record."""
    for joint, measured in record.joints.items():
        if not np.array_equal(np.asarray(measured.time), np.asarray(record.time)):
            raise InputError(f"joint {joint!r} must have the times of its record.")
    return dict(record.joints)


def levels_at(mechanism: Mechanism) -> Levels:
    """Return what levels of a law on this mechanism are.

    A load that was left at 1 says that no normal force is known.

    Examples
    --------
    >>> from stickslip import Axis, Pendulum, SpringBlock
    >>> [
    ...     levels_at(one)
    ...     for one in (
    ...         SpringBlock(mass=1.0),
    ...         Axis(inertia=1.0),
    ...         Axis(inertia=1.0, load=20.0),
    ...         Pendulum(mass=1.0, length=0.5),
    ...     )
    ... ]
    ['per load', 'forces', 'per load', 'torques']
    """
    contacts, load = mechanism.contacts(), mechanism.__dataclass_fields__.get("load")
    left = load is not None and load.default == 1.0 == vars(mechanism)["load"]
    if not (all(contact.load == 1.0 for contact in contacts) if len(contacts) > 1 else left):
        return "per load"
    return "torques" if slips_by_angle(mechanism) else "forces"


def tells_load(measurement: Measurement) -> bool:
    """Whether the normal force was measured, or is set by trial: levels are over it.

    Examples
    --------
    >>> tells_load(Measurement(velocity=[0.1], friction=[2.5], load=[5.0]))
    True
    """
    return "load" in measurement.quantities() or any(
        "mechanism.load" in record.overrides for record in measurement.records()
    )


def as_turning(measurement: Measurement, units: Collection[str]) -> Measurement:
    """Return a record of a mechanism all of whose coordinates are angles as one of angles.

    Examples
    --------
    >>> swing = Measurement(time=[0.0, 1.0], position=[0.0, 0.1])
    >>> as_turning(swing, ("rad",)).unit("position"), as_turning(swing, ("m",)).unit("position")
    ('rad', 'm')
    """
    if measurement.turning or {*units} != {"rad"} or measurement.joint_names():
        return measurement
    trials = tuple(replace(trial, turning=True) for trial in measurement.trials)
    return replace(measurement, trials=trials, turning=True)


def _numbers(name: str, quantity: Quantity, value: Any, turning: bool) -> Array | float:
    """Return a float, or a read-only copy of an array (n,), all finite."""
    label = f"Measurement.{name} ({quantity.symbol}) [{quantity.unit}]"
    if has_unit(value):
        value = _without_unit(name, quantity, value, turning)
    if isinstance(value, numbers.Real):
        return quantity.check("Measurement", name, value)
    try:
        raw = np.asarray(value)
        # Truth values, complex numbers, texts and dates would convert to something.
        array = None if raw.dtype.kind in "bcSUMm" else np.array(raw, dtype=float)
    except (TypeError, ValueError, OverflowError):
        array = None
    if array is None:
        raise ParameterError(f"{label} must be real numbers, got {_short(value)}.")
    if array.ndim == 0:
        return quantity.check("Measurement", name, array.item())
    if array.ndim != 1 or not array.size:
        raise ParameterError(f"{label} must have the shape (n,) with n > 0, got {array.shape}.")
    bad = np.flatnonzero(~np.isfinite(array))
    if bad.size:
        raise ParameterError(
            f"{label} must be finite, got {array[bad[0]]:g} at index {bad[0]}"
            f" ({bad.size} of {array.size} values). Remove those samples or fill the gaps."
        )
    array.setflags(write=False)
    return array


def _without_unit(name: str, quantity: Quantity, value: Any, turning: bool) -> Any:
    """Return what has a unit as a number, or as numbers, for this kind of motion."""
    unit = quantity.or_unit if turning and quantity.or_unit else quantity.unit
    try:
        return number_in(value, unit) if isinstance(value, str) else pint_magnitude(value, unit)
    except ParameterError as error:
        cure = "; measurements about an axis have turning=True" if quantity.or_unit else ""
        label = f"Measurement.{name} ({quantity.symbol}) [{unit}]"
        raise ParameterError(f"{label} {error}{cure * (not turning)}.") from None


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _check_shapes(record: Measurement) -> None:
    sizes = {
        name: np.size(getattr(record, name))
        for name in SAMPLED
        if isinstance(getattr(record, name), np.ndarray)
    }
    inputs = {k: np.size(x) for k, x in record.inputs.items() if isinstance(x, np.ndarray)}
    if record.time is not None:
        wrong = [name for name, size in inputs.items() if size != np.size(record.time)]
    else:
        wrong = [name for name, size in inputs.items() if size not in sizes.values()]
    if wrong:
        raise InputError(
            f"Measurement.inputs of {wrong[0]!r} has {inputs[wrong[0]]} values: give one number, or"
            " one for each sample."
        )
    if record.time is not None:
        _check_time(record, sizes)
        return
    if not sizes:
        return
    if "friction" not in sizes or "velocity" not in sizes:
        raise InputError(_without_time(sizes))
    if len(set(sizes.values())) > 1:
        raise InputError(
            f"The arrays of a friction map must be equally long, got {_listed(sizes)}."
        )


def _without_time(sizes: Mapping[str, int]) -> str:
    """Return what is wrong with arrays that are no friction map."""
    text = f"Measurement.{next(iter(sizes))} is an array without times: give time [s], or give"
    text += " friction and velocity together as a friction map. Of a file, the rate of its rows"
    text += ' will do, as columns={"time": "50 Hz"}.'
    if {"friction", "position"} <= {*sizes}:
        text += (
            " Friction over distance needs the time of each sample: add a column of times, the"
            " distance divided by the speed of the test."
        )
    return text


def _check_time(record: Measurement, sizes: Mapping[str, int]) -> None:
    time = record.time
    if not isinstance(time, np.ndarray) or time.size < 2:
        raise InputError("Measurement.time (t) [s] must be an array of at least 2 times.")
    if not sizes and not record.joints:
        raise InputError(
            f"Measurement.time (t) is given without samples: give one of {', '.join(SAMPLED)}"
            " with as many values."
        )
    if {*sizes.values()} - {time.size}:
        raise InputError(f"All arrays must be as long as time ({time.size}), got {_listed(sizes)}.")
    for name in SAMPLED:
        if name != "load" and isinstance(getattr(record, name), float):  # a weight stays
            raise InputError(
                f"Measurement.{name} is a single number, but there are {time.size} times: give an"
                " array."
            )
    late = np.flatnonzero(np.diff(time) <= 0)
    if late.size:
        i = int(late[0])
        raise InputError(
            f"Measurement.time (t) [s] must increase strictly, got {time[i]:.12g} before"
            f" {time[i + 1]:.12g} at index {i + 1}. Sort the samples and remove duplicates; for a"
            ' file, repair="sort" does both.'
        )


def _listed(sizes: Mapping[str, int]) -> str:
    return ", ".join(f"{name} {size}" for name, size in sizes.items())


def _present(where: str, name: str, known: tuple[str, ...]) -> None:
    if name not in known:
        raise UnknownNameError(f"quantity in {where}", name, known)


def _uncertainty(record: Measurement) -> dict[str, Array | float]:
    given: Any = record.uncertainty
    present = record.quantities()
    if not isinstance(given, Mapping):
        if len(present) != 1:
            raise InputError(
                "Measurement.uncertainty must be a mapping by quantity where there are several"
                f" ({', '.join(present)}), got {given!r}."
            )
        given = {present[0]: given}
    checked: dict[str, Array | float] = {}
    for name, value in given.items():
        _present("uncertainty", name, present)
        known = quantity_called(name)
        quantity = Quantity(f"u_{known.symbol}", known.unit, above=0, or_unit=known.or_unit)
        checked[name] = doubt = _numbers(f"uncertainty.{name}", quantity, value, record.turning)
        if isinstance(doubt, np.ndarray):
            _check_doubts(record, name, doubt, quantity)
        for item in np.atleast_1d(doubt) if name in TRAVELS else ():
            _check_size("Measurement.uncertainty", name, float(item), quantity)
    return checked


def _check_doubts(record: Measurement, name: str, doubt: Array, quantity: Quantity) -> None:
    """Refuse uncertainties that are not one from 0 for each value of a quantity."""
    first, _, joint = name.partition(".")
    size = np.size(getattr(record.joints[joint] if joint else record, first))
    bad = np.flatnonzero(doubt < 0.0)
    if doubt.size != size or bad.size:
        got = f"{doubt[bad[0]]:g} at index {bad[0]}" if bad.size else f"{doubt.size} numbers"
        raise ParameterError(
            f"Measurement.uncertainty.{name} ({quantity.symbol}) [{record.unit(name)}] must be a"
            f" number above 0, or {size} from 0, one for each, got {got}: correct or leave it out."
        )


def _check_size(owner: str, name: str, value: float, quantity: Quantity) -> None:
    """Refuse a number whose square or reciprocal need not be one."""
    wanted = size_wanted(value, quantity)
    if wanted:
        raise ParameterError(
            f"{owner}.{name} ({quantity.symbol}) must {wanted}, got {value:g}: correct the number"
            " or its unit."
        )


def _floats(owner: str, given: object) -> dict[str, float]:
    if not isinstance(given, Mapping):
        raise InputError(f"Measurement.{owner} must be a mapping by name, got {given!r}.")
    for name, value in given.items():
        is_number = isinstance(value, numbers.Real) and not isinstance(value, bool)
        if not (is_number and math.isfinite(value)):
            raise ParameterError(
                f"Measurement.{owner} of {name!r} must be a finite number, got {value!r}."
            )
        if abs(value) > LARGEST_NUMBER:
            raise ParameterError(
                f"Measurement.{owner} of {name!r} must be {LARGEST_NUMBER:g} at most, in magnitude,"
                f" got {value:g}: correct the number or its unit."
            )
    return {str(name): float(value) for name, value in given.items()}


def _positive(owner: str, given: object) -> dict[str, float]:
    result = _floats(owner, given)
    for name, value in result.items():
        if not value > 0.0:
            raise ParameterError(
                f"Measurement.{owner} of {name!r} must be a standard uncertainty above 0, in the"
                f" SI unit of the parameter, got {value:g}. Leave it out if the value is exact."
            )
    return result


def _check_trials(whole: Measurement) -> None:
    trials: tuple[Any, ...] = whole.trials
    for trial in trials:
        if not isinstance(trial, Measurement) or trial.trials:
            raise InputError(f"Each of Measurement.trials must be one record, got {_short(trial)}.")
    # Beside trials these would silently have no effect.
    arrays = [name for name in ("time", *QUANTITIES) if getattr(whole, name) is not None]
    settings = ("uncertainty", "overrides", "conditions", "inputs", "initial", "offset", "joints")
    own = arrays + [name for name in settings if np.ndim(x := getattr(whole, name)) or x]
    if own:
        raise InputError(
            f"Measurement.{own[0]} is given beside trials: give it for each trial instead."
        )
    kinds = sorted({trial.kind for trial in whole.trials})
    if len(kinds) > 1:
        raise InputError(
            f"Trials must be of one kind, got {' and '.join(kinds)}: analyse them separately."
        )
    if len({frozenset(trial.joints) for trial in whole.trials}) > 1:
        raise InputError("Trials must have the same joints: analyse the others separately.")
    names = Counter(trial.name for trial in whole.trials if trial.name)
    twice = [name for name, count in names.items() if count > 1]
    if twice:
        which = [str(i) for i, trial in enumerate(whole.trials, 1) if trial.name == twice[0]]
        raise InputError(
            f"Trials {joined(which)} have the same name, {twice[0]!r}: give each trial its own."
        )
