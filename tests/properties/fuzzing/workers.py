"""Runs a campaign in a process that can be ended when a case hangs in compiled code."""

import multiprocessing
from collections.abc import Iterator
from multiprocessing.connection import Connection

from tests.properties.fuzzing.campaign import Campaign, Outcome

__all__ = ["outcomes"]

WAITS = 10.0
"""Time that a case may take over its limit, which is of processor time."""
COMPILING = 3600.0
"""Seconds that compiling the equations of a case may take [s]."""


def _work(campaign: Campaign, indices: list[int], answers: Connection) -> None:
    """Run cases in a process of its own, which can be ended when it hangs."""
    for index in indices:
        campaign.warm_up(index)
        answers.send(None)
        answers.send(campaign.outcome(index))
    answers.close()


def outcomes(campaign: Campaign, indices: list[int]) -> Iterator[Outcome]:
    """Yield the outcome of each case; one that cannot be interrupted is ended with its process."""
    context = multiprocessing.get_context("spawn")
    while indices:
        receiver, sender = context.Pipe(duplex=False)
        process = context.Process(target=_work, args=(campaign, indices, sender))
        process.start()
        sender.close()
        while indices:
            try:
                lost = "no answer"
                answered = receiver.poll(COMPILING) and receiver.recv() is None
                answered = answered and receiver.poll(WAITS * campaign.seconds)
                outcome = receiver.recv() if answered else None
            except EOFError:
                outcome, lost = None, "the process died"
            index, *indices = indices
            if outcome is None:
                title = campaign.case(index).title
                found = (("ends in time", lost),)
                yield Outcome(
                    index=index, title=title, status="hang", reason=lost, violations=found
                )
                break
            yield outcome
        process.kill()
        process.join()
