import pytest

from stickslip.solver import run


@pytest.fixture(autouse=True, scope="module")
def random_rigs_stay_in_plain_python():
    """Count no steps: rigs are of so many kinds that compiling each would take minutes."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run, "PLAIN_STEP", 0.0)
        yield
