# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from dataclasses import dataclass

from stickslip.friction.base import ALWAYS as ALWAYS
from stickslip.friction.base import BristleLaw as BristleLaw
from stickslip.friction.base import BristleLaw as _BristleLaw
from stickslip.friction.base import Containment as Containment
from stickslip.friction.base import Friction as Friction
from stickslip.friction.base import FrictionLaw as FrictionLaw
from stickslip.friction.base import FrictionLaw as _FrictionLaw
from stickslip.friction.base import Laws as Laws
from stickslip.friction.base import Passivity as Passivity
from stickslip.friction.base import SetValuedLaw as SetValuedLaw
from stickslip.friction.base import SetValuedLaw as _SetValuedLaw
from stickslip.friction.base import Typical as Typical
from stickslip.friction.base import anywhere as anywhere
from stickslip.friction.base import assigned as assigned
from stickslip.friction.base import bound as bound
from stickslip.friction.base import bristle_names as bristle_names
from stickslip.friction.base import force_parameters as force_parameters
from stickslip.friction.base import given_to as given_to
from stickslip.friction.base import is_bound as is_bound
from stickslip.friction.base import law_of as law_of
from stickslip.friction.classes import CITATIONS as CITATIONS
from stickslip.friction.classes import SOURCES as SOURCES
from stickslip.friction.classes import containment_of as containment_of
from stickslip.friction.classes import said_of as said_of
from stickslip.friction.parts import PARTS as PARTS
from stickslip.friction.parts.levels import curve_through as curve_through
from stickslip.friction.parts.levels import curves_beside as curves_beside
from stickslip.friction.parts.levels import monotone_slopes as monotone_slopes
from stickslip.friction.published import PRINTED_EQUATIONS as PRINTED_EQUATIONS
from stickslip.friction.published import PRINTED_FORMS as PRINTED_FORMS
from stickslip.friction.published import PrintedCartDynamics as _PrintedCartDynamics
from stickslip.friction.published import PrintedCoulomb as _PrintedCoulomb
from stickslip.friction.published import PrintedForm as PrintedForm
from stickslip.friction.published import PrintedStribeck as _PrintedStribeck
from stickslip.friction.published import RightEquation as RightEquation
from stickslip.friction.published import TISSUES as TISSUES
from stickslip.friction.published import Tissue as Tissue
from stickslip.friction.rate_state import Evolution as Evolution
from stickslip.friction.rate_state import Evolution as _Evolution
from stickslip.friction.rate_state import RATE_STATE_FORMS as RATE_STATE_FORMS
from stickslip.friction.rate_state import RateState as _RateState
from stickslip.friction.rate_state import RateStateForm as RateStateForm
from stickslip.friction.registry import CandidateSpec as CandidateSpec
from stickslip.friction.registry import LAWS as LAWS
from stickslip.friction.registry import contained_laws as contained_laws
from stickslip.friction.registry import is_composition as is_composition
from stickslip.friction.registry import law as law
from stickslip.friction.registry import law_type as law_type
from stickslip.friction.registry import laws as laws
from stickslip.friction.registry import listed as listed
from stickslip.friction.registry import specification as specification
from stickslip.friction.registry import usual_specifications as usual_specifications
from stickslip.friction.registry import with_typical_values as with_typical_values
from stickslip.maths import Scalar as _Scalar
from stickslip.quantities import Given as _Given
from typing_extensions import override as _override

LAW_MODULES: dict[str, str]

@dataclass(frozen=True, kw_only=True, init=False)
class Ambrosio(_SetValuedLaw):
    kinetic_coefficient: float
    smoothing_velocity: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        smoothing_velocity: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class ArctanCoulomb(_SetValuedLaw):
    kinetic_coefficient: float
    smoothing_velocity: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        smoothing_velocity: _Given,
        viscous_coefficient: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class BamM1(_SetValuedLaw):
    kinetic_coefficient: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        viscous_coefficient: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class BamM2(_SetValuedLaw):
    kinetic_coefficient: float
    static_coefficient: float
    stribeck_velocity: float
    fading_exponent: float = ...
    viscous_coefficient: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        viscous_coefficient: _Given,
        fading_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class BamM3(_SetValuedLaw):
    kinetic_coefficient: float
    transmitted_coefficient: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        transmitted_coefficient: _Given,
        viscous_coefficient: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class BamM4(_SetValuedLaw):
    kinetic_coefficient: float
    static_coefficient: float
    stribeck_velocity: float
    fading_exponent: float = ...
    transmitted_coefficient: float
    transmitted_static_surplus: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        transmitted_coefficient: _Given,
        transmitted_static_surplus: _Given,
        viscous_coefficient: _Given,
        fading_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class BamM5(_SetValuedLaw):
    kinetic_coefficient: float
    static_coefficient: float
    stribeck_velocity: float
    fading_exponent: float = ...
    motor_friction: float
    external_friction: float
    motor_static_friction: float
    external_static_friction: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        motor_friction: _Given,
        external_friction: _Given,
        motor_static_friction: _Given,
        external_static_friction: _Given,
        viscous_coefficient: _Given,
        fading_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class BamM6(_SetValuedLaw):
    kinetic_coefficient: float
    static_coefficient: float
    stribeck_velocity: float
    fading_exponent: float = ...
    motor_friction: float
    external_friction: float
    motor_static_friction: float
    external_static_friction: float
    motor_quadratic: float
    external_quadratic: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        motor_friction: _Given,
        external_friction: _Given,
        motor_static_friction: _Given,
        external_static_friction: _Given,
        motor_quadratic: _Given,
        external_quadratic: _Given,
        viscous_coefficient: _Given,
        fading_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class BlimanSorine(_BristleLaw):
    kinetic_coefficient: float
    bristle_stiffness: float
    surplus_share: float
    distance_ratio: float
    def __init__(
        self,
        *,
        static_switch: bool = ...,
        kinetic_coefficient: _Given,
        bristle_stiffness: _Given,
        surplus_share: _Given,
        distance_ratio: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def force(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...] = ...) -> _Scalar: ...
    @_override
    def rates(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...]) -> tuple[_Scalar, ...]: ...
    @_override
    def steady(self, velocity: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class BoucWen(_BristleLaw):
    kinetic_coefficient: float
    bristle_stiffness: float
    loop_exponent: float = ...
    loop_share: float = ...
    viscous_coefficient: float
    def __init__(
        self,
        *,
        static_switch: bool = ...,
        kinetic_coefficient: _Given,
        bristle_stiffness: _Given,
        loop_share: _Given = ...,
        viscous_coefficient: _Given,
        loop_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def force(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...] = ...) -> _Scalar: ...
    @_override
    def rates(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...]) -> tuple[_Scalar, ...]: ...
    @_override
    def steady(self, velocity: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class BrownMcPhee(_SetValuedLaw):
    kinetic_coefficient: float
    static_coefficient: float
    transition_velocity: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        transition_velocity: _Given,
        viscous_coefficient: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Cogging(_SetValuedLaw):
    kinetic_coefficient: float
    level_position_cosine: float
    level_position_sine: float
    level_position_harmonic: float = ...
    viscous_coefficient: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        level_position_cosine: _Given,
        level_position_sine: _Given,
        level_position_harmonic: _Given = ...,
        viscous_coefficient: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Coulomb(_SetValuedLaw):
    kinetic_coefficient: float
    static_coefficient: float | None = ...
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        static_coefficient: _Given | None = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class CoulombViscous(_SetValuedLaw):
    kinetic_coefficient: float
    viscous_coefficient: float
    static_coefficient: float | None = ...
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        viscous_coefficient: _Given,
        static_coefficient: _Given | None = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class CoulombViscousStatic(_SetValuedLaw):
    kinetic_coefficient: float
    static_coefficient: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        viscous_coefficient: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Dahl(_BristleLaw):
    kinetic_coefficient: float
    bristle_stiffness: float
    yield_exponent: float = ...
    viscous_coefficient: float = ...
    viscous_exponent: float = ...
    def __init__(
        self,
        *,
        static_switch: bool = ...,
        kinetic_coefficient: _Given,
        bristle_stiffness: _Given,
        viscous_coefficient: _Given = ...,
        yield_exponent: _Given = ...,
        viscous_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def force(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...] = ...) -> _Scalar: ...
    @_override
    def rates(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...]) -> tuple[_Scalar, ...]: ...
    @_override
    def steady(self, velocity: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class DahlStribeck(_BristleLaw):
    kinetic_coefficient: float
    static_coefficient: float
    stribeck_velocity: float
    fading_exponent: float = ...
    bristle_stiffness: float
    yield_exponent: float = ...
    viscous_coefficient: float
    viscous_exponent: float = ...
    def __init__(
        self,
        *,
        static_switch: bool = ...,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        bristle_stiffness: _Given,
        viscous_coefficient: _Given,
        fading_exponent: _Given = ...,
        yield_exponent: _Given = ...,
        viscous_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def force(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...] = ...) -> _Scalar: ...
    @_override
    def rates(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...]) -> tuple[_Scalar, ...]: ...
    @_override
    def steady(self, velocity: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class DirectionDependent(_FrictionLaw):
    forward_kinetic_coefficient: float
    backward_kinetic_coefficient: float
    forward_viscous_coefficient: float = ...
    backward_viscous_coefficient: float = ...
    def __init__(
        self,
        *,
        forward_kinetic_coefficient: _Given,
        backward_kinetic_coefficient: _Given,
        forward_viscous_coefficient: _Given = ...,
        backward_viscous_coefficient: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def force(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...] = ...) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class DirectionalDahl(_BristleLaw):
    forward_kinetic_coefficient: float
    backward_kinetic_coefficient: float
    forward_static_coefficient: float
    backward_static_coefficient: float
    stribeck_velocity: float
    fading_exponent: float = ...
    bristle_stiffness: float
    yield_exponent: float = ...
    forward_viscous_coefficient: float
    backward_viscous_coefficient: float
    viscous_exponent: float = ...
    def __init__(
        self,
        *,
        static_switch: bool = ...,
        forward_kinetic_coefficient: _Given,
        backward_kinetic_coefficient: _Given,
        forward_static_coefficient: _Given,
        backward_static_coefficient: _Given,
        stribeck_velocity: _Given,
        bristle_stiffness: _Given,
        forward_viscous_coefficient: _Given,
        backward_viscous_coefficient: _Given,
        fading_exponent: _Given = ...,
        yield_exponent: _Given = ...,
        viscous_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def force(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...] = ...) -> _Scalar: ...
    @_override
    def rates(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...]) -> tuple[_Scalar, ...]: ...
    @_override
    def steady(self, velocity: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class DirectionalLuGre(_BristleLaw):
    forward_kinetic_coefficient: float
    backward_kinetic_coefficient: float
    forward_static_coefficient: float
    backward_static_coefficient: float
    stribeck_velocity: float
    fading_exponent: float = ...
    bristle_stiffness: float
    bristle_damping: float
    forward_viscous_coefficient: float
    backward_viscous_coefficient: float
    def __init__(
        self,
        *,
        static_switch: bool = ...,
        forward_kinetic_coefficient: _Given,
        backward_kinetic_coefficient: _Given,
        forward_static_coefficient: _Given,
        backward_static_coefficient: _Given,
        stribeck_velocity: _Given,
        bristle_stiffness: _Given,
        bristle_damping: _Given,
        forward_viscous_coefficient: _Given,
        backward_viscous_coefficient: _Given,
        fading_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def force(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...] = ...) -> _Scalar: ...
    @_override
    def rates(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...]) -> tuple[_Scalar, ...]: ...
    @_override
    def steady(self, velocity: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class DirectionalStribeck(_FrictionLaw):
    forward_kinetic_coefficient: float
    backward_kinetic_coefficient: float
    forward_static_coefficient: float
    backward_static_coefficient: float
    forward_stribeck_velocity: float
    backward_stribeck_velocity: float
    forward_fading_exponent: float = ...
    backward_fading_exponent: float = ...
    forward_viscous_coefficient: float
    backward_viscous_coefficient: float
    def __init__(
        self,
        *,
        forward_kinetic_coefficient: _Given,
        backward_kinetic_coefficient: _Given,
        forward_static_coefficient: _Given,
        backward_static_coefficient: _Given,
        forward_stribeck_velocity: _Given,
        backward_stribeck_velocity: _Given,
        forward_viscous_coefficient: _Given,
        backward_viscous_coefficient: _Given,
        forward_fading_exponent: _Given = ...,
        backward_fading_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def force(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...] = ...) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class ElastoPlastic(_BristleLaw):
    kinetic_coefficient: float
    static_coefficient: float
    stribeck_velocity: float
    fading_exponent: float = ...
    bristle_stiffness: float
    bristle_damping: float
    elastic_share: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        static_switch: bool = ...,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        bristle_stiffness: _Given,
        bristle_damping: _Given,
        elastic_share: _Given,
        viscous_coefficient: _Given,
        fading_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def force(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...] = ...) -> _Scalar: ...
    @_override
    def rates(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...]) -> tuple[_Scalar, ...]: ...
    @_override
    def steady(self, velocity: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class GMS(_BristleLaw):
    kinetic_coefficient: float
    static_coefficient: float
    stribeck_velocity: float
    fading_exponent: float = ...
    bristle_stiffness: float
    attraction: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        static_switch: bool = ...,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        bristle_stiffness: _Given,
        attraction: _Given,
        viscous_coefficient: _Given,
        fading_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def force(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...] = ...) -> _Scalar: ...
    @_override
    def rates(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...]) -> tuple[_Scalar, ...]: ...
    @_override
    def steady(self, velocity: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class HaessigFriedland(_BristleLaw):
    kinetic_coefficient: float
    bristle_stiffness: float
    bristle_damping: float
    sticking_surplus: float
    def __init__(
        self,
        *,
        static_switch: bool = ...,
        kinetic_coefficient: _Given,
        bristle_stiffness: _Given,
        bristle_damping: _Given,
        sticking_surplus: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def force(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...] = ...) -> _Scalar: ...
    @_override
    def rates(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...]) -> tuple[_Scalar, ...]: ...
    @_override
    def steady(self, velocity: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class HessSoom(_SetValuedLaw):
    kinetic_coefficient: float
    static_coefficient: float
    stribeck_velocity: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        viscous_coefficient: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class JointLoadTemperature(_SetValuedLaw):
    kinetic_coefficient: float
    static_coefficient: float
    stribeck_velocity: float
    fading_exponent: float = ...
    stribeck_velocity_temperature_slope: float
    gravity_coefficient: float
    gravity_static_surplus: float
    viscous_coefficient: float
    viscous_temperature_decay: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        stribeck_velocity_temperature_slope: _Given,
        gravity_coefficient: _Given,
        gravity_static_surplus: _Given,
        viscous_coefficient: _Given,
        viscous_temperature_decay: _Given,
        fading_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class LuGre(_BristleLaw):
    kinetic_coefficient: float
    static_coefficient: float
    stribeck_velocity: float
    fading_exponent: float = ...
    bristle_stiffness: float
    bristle_damping: float
    viscous_coefficient: float = ...
    viscous_exponent: float = ...
    def __init__(
        self,
        *,
        static_switch: bool = ...,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        bristle_stiffness: _Given,
        bristle_damping: _Given,
        viscous_coefficient: _Given = ...,
        fading_exponent: _Given = ...,
        viscous_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def force(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...] = ...) -> _Scalar: ...
    @_override
    def rates(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...]) -> tuple[_Scalar, ...]: ...
    @_override
    def steady(self, velocity: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class LuGreFading(_BristleLaw):
    kinetic_coefficient: float
    static_coefficient: float
    stribeck_velocity: float
    fading_exponent: float = ...
    bristle_stiffness: float
    bristle_damping: float
    damping_velocity: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        static_switch: bool = ...,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        bristle_stiffness: _Given,
        bristle_damping: _Given,
        damping_velocity: _Given,
        viscous_coefficient: _Given,
        fading_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def force(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...] = ...) -> _Scalar: ...
    @_override
    def rates(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...]) -> tuple[_Scalar, ...]: ...
    @_override
    def steady(self, velocity: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class LuGreGear(_BristleLaw):
    kinetic_coefficient: float
    static_coefficient: float
    stribeck_velocity: float
    fading_exponent: float = ...
    transmitted_coefficient: float
    bristle_stiffness: float
    bristle_damping: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        static_switch: bool = ...,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        transmitted_coefficient: _Given,
        bristle_stiffness: _Given,
        bristle_damping: _Given,
        viscous_coefficient: _Given,
        fading_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def force(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...] = ...) -> _Scalar: ...
    @_override
    def rates(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...]) -> tuple[_Scalar, ...]: ...
    @_override
    def steady(self, velocity: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class MaxwellSlip(_BristleLaw):
    kinetic_coefficient: float
    bristle_stiffness: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        static_switch: bool = ...,
        kinetic_coefficient: _Given,
        bristle_stiffness: _Given,
        viscous_coefficient: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def force(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...] = ...) -> _Scalar: ...
    @_override
    def rates(self, velocity: _Scalar, load: _Scalar, states: tuple[_Scalar, ...]) -> tuple[_Scalar, ...]: ...
    @_override
    def steady(self, velocity: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class PoppStelter(_SetValuedLaw):
    kinetic_coefficient: float
    static_coefficient: float
    stribeck_velocity: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        viscous_coefficient: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class PowerViscous(_SetValuedLaw):
    kinetic_coefficient: float
    viscous_coefficient: float
    viscous_exponent: float = ...
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        viscous_coefficient: _Given,
        viscous_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class PrintedCartDynamics(_PrintedCartDynamics):
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        weight: _Given,
        signed: bool = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class PrintedCoulomb(_PrintedCoulomb):
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class PrintedStribeck(_PrintedStribeck):
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        viscous_coefficient: _Given = ...,
        signed: bool = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class QuadraticDrag(_SetValuedLaw):
    kinetic_coefficient: float
    viscous_coefficient: float = ...
    quadratic_coefficient: float = ...
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        viscous_coefficient: _Given = ...,
        quadratic_coefficient: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class RateState(_RateState):
    def __init__(
        self,
        *,
        reference_coefficient: _Given,
        direct_effect: _Given,
        evolution_effect: _Given = ...,
        critical_distance: _Given | None = ...,
        second_evolution_effect: _Given = ...,
        second_critical_distance: _Given | None = ...,
        stress_effect: _Given = ...,
        reference_velocity: _Given,
        evolution: _Evolution = ...,
        regularised: bool = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class RootCoulomb(_SetValuedLaw):
    kinetic_coefficient: float
    smoothing_velocity: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        smoothing_velocity: _Given,
        viscous_coefficient: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class SaturatingViscous(_SetValuedLaw):
    kinetic_coefficient: float
    viscous_coefficient: float
    saturation_velocity: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        viscous_coefficient: _Given,
        saturation_velocity: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Simscape(_SetValuedLaw):
    kinetic_coefficient: float
    static_coefficient: float
    breakaway_velocity: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        breakaway_velocity: _Given,
        viscous_coefficient: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Stribeck(_SetValuedLaw):
    kinetic_coefficient: float
    static_coefficient: float
    stribeck_velocity: float
    fading_exponent: float = ...
    viscous_coefficient: float = ...
    break_away_coefficient: float | None = ...
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        viscous_coefficient: _Given = ...,
        break_away_coefficient: _Given | None = ...,
        fading_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class StribeckPower(_SetValuedLaw):
    kinetic_coefficient: float
    static_coefficient: float
    stribeck_velocity: float
    fading_exponent: float = ...
    viscous_coefficient: float
    viscous_exponent: float = ...
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        viscous_coefficient: _Given,
        fading_exponent: _Given = ...,
        viscous_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class TanhCoulomb(_SetValuedLaw):
    kinetic_coefficient: float
    smoothing_velocity: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        smoothing_velocity: _Given,
        viscous_coefficient: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class TanhStribeck(_SetValuedLaw):
    kinetic_coefficient: float
    static_coefficient: float
    stribeck_velocity: float
    fading_exponent: float = ...
    smoothing_velocity: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        smoothing_velocity: _Given,
        viscous_coefficient: _Given,
        fading_exponent: _Given = ...,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Threlfall(_SetValuedLaw):
    kinetic_coefficient: float
    smoothing_velocity: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        smoothing_velocity: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Tustin(_SetValuedLaw):
    kinetic_coefficient: float
    static_coefficient: float
    stribeck_velocity: float
    viscous_coefficient: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        static_coefficient: _Given,
        stribeck_velocity: _Given,
        viscous_coefficient: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Viscous(_SetValuedLaw):
    viscous_coefficient: float
    def __init__(
        self,
        *,
        viscous_coefficient: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

@dataclass(frozen=True, kw_only=True, init=False)
class WarmViscous(_SetValuedLaw):
    kinetic_coefficient: float
    viscous_coefficient: float
    viscous_temperature_decay: float
    def __init__(
        self,
        *,
        kinetic_coefficient: _Given,
        viscous_coefficient: _Given,
        viscous_temperature_decay: _Given,
    ) -> None: ...
    @_override
    def break_away(self, load: _Scalar) -> _Scalar: ...
    @_override
    def sliding(self, speed: _Scalar, load: _Scalar) -> _Scalar: ...

__all__ = [
    "Ambrosio",
    "ArctanCoulomb",
    "BamM1",
    "BamM2",
    "BamM3",
    "BamM4",
    "BamM5",
    "BamM6",
    "BlimanSorine",
    "BoucWen",
    "BristleLaw",
    "BrownMcPhee",
    "CandidateSpec",
    "Cogging",
    "Containment",
    "Coulomb",
    "CoulombViscous",
    "CoulombViscousStatic",
    "Dahl",
    "DahlStribeck",
    "DirectionDependent",
    "DirectionalDahl",
    "DirectionalLuGre",
    "DirectionalStribeck",
    "ElastoPlastic",
    "Evolution",
    "Friction",
    "FrictionLaw",
    "GMS",
    "HaessigFriedland",
    "HessSoom",
    "JointLoadTemperature",
    "LAWS",
    "Laws",
    "LuGre",
    "LuGreFading",
    "LuGreGear",
    "MaxwellSlip",
    "PRINTED_EQUATIONS",
    "PRINTED_FORMS",
    "Passivity",
    "PoppStelter",
    "PowerViscous",
    "PrintedForm",
    "QuadraticDrag",
    "RATE_STATE_FORMS",
    "RateState",
    "RateStateForm",
    "RightEquation",
    "RootCoulomb",
    "SOURCES",
    "SaturatingViscous",
    "SetValuedLaw",
    "Simscape",
    "Stribeck",
    "StribeckPower",
    "TISSUES",
    "TanhCoulomb",
    "TanhStribeck",
    "Threlfall",
    "Tissue",
    "Tustin",
    "Typical",
    "Viscous",
    "WarmViscous",
    "bound",
    "contained_laws",
    "containment_of",
    "law",
    "law_type",
    "laws",
    "specification",
    "usual_specifications",
]
