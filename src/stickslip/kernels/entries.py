"""The kernels that are called from outside, as the compiled tier names them too."""

from stickslip.kernels.batch import batch as enter_batch
from stickslip.kernels.batch import batch_sensed as enter_batch_sensed
from stickslip.kernels.contacts.answers import answer as enter_contacts
from stickslip.kernels.dense_evaluation import play as enter_play
from stickslip.kernels.driver import run as enter_run
from stickslip.kernels.exchange import exchange as enter_exchange
from stickslip.kernels.sensitivities import sense as enter_sense
from stickslip.kernels.stretches import stretches as enter_stretches

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
