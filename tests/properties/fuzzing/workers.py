"""Runs a campaign in processes that can be ended when a case hangs in compiled code."""

import multiprocessing
import queue
import threading
from collections.abc import Iterator
from multiprocessing.connection import Connection

from tests.properties.fuzzing.campaign import Campaign, Outcome

WAITS = 10.0
"""Time that a case may take over its limit, which is of processor time."""
COMPILING = 600.0
"""Seconds that compiling the equations of a case, and a first step, may take [s]."""
MANY = 500
"""Cases after which a process makes room for a new one: it keeps what it has compiled."""


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
        batch = indices[:MANY]
        process = context.Process(target=_work, args=(campaign, batch, sender))
        process.start()
        sender.close()
        for _ in batch:
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


def outcomes_side_by_side(
    campaign: Campaign, indices: list[int], processes: int
) -> Iterator[Outcome]:
    """Yield the outcome of each case as they come from several processes at once."""
    found: queue.Queue[Outcome | None] = queue.Queue()

    def follow(own: list[int]) -> None:
        for outcome in outcomes(campaign, own):
            found.put(outcome)
        found.put(None)

    share = -(-len(indices) // processes)  # neighbours have the same equations
    parts = [indices[k : k + share] for k in range(0, len(indices), share)]
    for part in parts:
        threading.Thread(target=follow, args=(part,), daemon=True).start()
    running = len(parts)
    while running:
        outcome = found.get()
        if outcome is None:
            running -= 1
        else:
            yield outcome
