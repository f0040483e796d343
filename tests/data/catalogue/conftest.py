import pytest
from tests.upstream import MATLAB, TEXT, Upstream


@pytest.fixture
def upstream(monkeypatch, tmp_path):
    """A server with two files, an empty cache, no folder of data."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    monkeypatch.delenv("STICKSLIP_DATA", raising=False)
    with Upstream() as server:
        monkeypatch.setenv("STICKSLIP_DATA_URL", server.address)
        server.offer("data/a%20slide.txt", TEXT.encode())
        server.offer("slide.mat", MATLAB)
        yield server
