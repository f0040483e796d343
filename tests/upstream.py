"""A web server on this machine in place of upstream, and records to get from it."""

import hashlib
import http.server
import io
import threading
from typing import Self

import numpy as np
from scipy.io import savemat
from typing_extensions import override

from stickslip.data.catalogue import Column, DataFile, Dataset

REPOSITORY, COMMIT = "someone/slides", "0123456789abcdef0123456789abcdef01234567"

TIMES = np.arange(6) * 0.1
SPEEDS = np.array([0.0, 1.0, 1.5, 1.5, 0.5, 0.0], dtype=np.float32)
TEXT = "Time [s]\tFriction [uN]\n" + "".join(f"{i / 10:g}\t{100.1 + i}\n" for i in range(6))


def matlab_file(**variables: np.ndarray) -> bytes:
    file = io.BytesIO()
    savemat(file, variables)
    return file.getvalue()


MATLAB = matlab_file(t=TIMES[:, None], speed=SPEEDS[None, :], other=np.eye(2))


def sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def text_record(content: bytes = TEXT.encode(), *, known: bytes | None = None) -> Dataset:
    """A record in a text with a part and the whole; `known` is what its checksum is of."""
    checksum = sha256(content if known is None else known)
    source = {"source": "data/a slide.txt", "source_sha256": checksum}
    return Dataset(
        name="slide",
        title="A slide",
        kind="measured",
        citation="Someone.",
        licence="MIT",
        repository=REPOSITORY,
        commit=COMMIT,
        format="tsv",
        columns=(
            Column(name="t_s", unit="s", meaning="time", quantity="time", source="1"),
            Column(
                name="friction_N",
                unit="N",
                meaning="friction, the other way",
                quantity="friction",
                gain=-1.0,
                source="2",
                factor=1e-6,
            ),
        ),
        files={
            "start": DataFile(name="start", about="The start.", rows=4, part=True, **source),
            "all": DataFile(name="all", about="All.", rows=6, **source),
        },
    )


def matlab_record(content: bytes = MATLAB) -> Dataset:
    source = {"source": "slide.mat", "source_sha256": sha256(content)}
    return Dataset(
        name="matlab_slide",
        title="A slide",
        kind="measured",
        citation="Someone.",
        licence="MIT",
        repository=REPOSITORY,
        commit=COMMIT,
        format="mat",
        columns=(
            Column(name="t_s", unit="s", meaning="time", quantity="time", source="t"),
            Column(name="v", unit="m/s", meaning="speed", quantity="velocity", source="speed"),
            Column(name="v_mm_s", unit="mm/s", meaning="speed", source="speed", factor=1e3),
        ),
        files={"all": DataFile(name="all", about="All.", rows=6, **source)},
    )


class _Handler(http.server.BaseHTTPRequestHandler):
    def do_GET(self) -> None:
        upstream: Upstream = self.server.upstream  # type: ignore[attr-defined]
        upstream.asked.append(self.path)
        content = upstream.files.get(self.path)
        if content is None:
            self.send_error(404)
            return
        self.send_response(200)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content[: len(content) // 2] if upstream.breaks_off else content)

    @override
    def log_message(self, *arguments: object) -> None:
        """Say nothing."""


class Upstream:
    """The server: `files` by path, `asked` paths in their order."""

    def __init__(self) -> None:
        self.files: dict[str, bytes] = {}
        self.asked: list[str] = []
        self.breaks_off = False
        self._server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), _Handler)
        self._server.upstream = self  # type: ignore[attr-defined]
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.01,))
        self.address = f"http://127.0.0.1:{self._server.server_port}"

    def offer(self, path: str, content: bytes) -> None:
        self.files[f"/{REPOSITORY}/{COMMIT}/{path}"] = content

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._server.shutdown()
        self._thread.join()
        self._server.server_close()
