"""The kernels that are called from outside, as the compiled tier names them too."""

from stickslip.kernels.batch import batch as enter_batch
from stickslip.kernels.batch import batch_sensed as enter_batch_sensed
from stickslip.kernels.batch import stretches as enter_stretches
from stickslip.kernels.contacts.transitions import answer as enter_contacts
from stickslip.kernels.driver import play as enter_play
from stickslip.kernels.driver import run as enter_run
from stickslip.kernels.exchange import exchange as enter_exchange
from stickslip.kernels.sensitivities import sense as enter_sense

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
