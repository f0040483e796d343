import pytest

from stickslip.engine.solver import run


@pytest.fixture(autouse=True, scope="module")
def random_rigs_stay_in_plain_python():
    """Count no time: rigs are of so many kinds that compiling each would take minutes."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run, "thread_time", lambda: 0.0)
        yield
