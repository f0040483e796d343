"""The kernels that are called from outside, as the compiled tier names them too."""

from stickslip.engine.kernels.batch import batch as enter_batch
from stickslip.engine.kernels.batch import batch_sensed as enter_batch_sensed
from stickslip.engine.kernels.batch import stretches as enter_stretches
from stickslip.engine.kernels.contacts.transitions import answer as enter_contacts
from stickslip.engine.kernels.driver import play as enter_play
from stickslip.engine.kernels.driver import run as enter_run
from stickslip.engine.kernels.exchange import exchange as enter_exchange
from stickslip.engine.kernels.sensitivities import sense as enter_sense

__all__ = [
    "enter_batch",
    "enter_batch_sensed",
    "enter_contacts",
    "enter_exchange",
    "enter_play",
    "enter_run",
    "enter_sense",
    "enter_stretches",
]
