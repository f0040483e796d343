"""Logs in MCAP: messages of ROS 2, or in JSON."""

from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path
from typing import Any, Final, final

from typing_extensions import override

from stickslip.errors import InputError
from stickslip.experiments.readers.expansion import check_mcap
from stickslip.experiments.readers.table import Table, json_of
from stickslip.experiments.readers.topics import Log, Topic, table_of
from stickslip.formatting import joined

MCAP: Final = (".mcap",)
LARGEST_JSON: Final = 2**24
"""Bytes of a message in JSON at most: as objects they take some twenty times as many."""


def read_mcap(path: Path, names: Collection[str] = ()) -> Table:
    """Return the states of joints in a log."""
    try:
        from mcap.decoder import DecoderFactory
        from mcap.exceptions import DecoderNotFoundError, McapError
        from mcap.reader import make_reader
        from mcap_ros2.decoder import DecoderFactory as Ros2
    except ImportError:
        raise InputError(
            f"{path}: MCAP files need the packages mcap and mcap-ros2-support: pip install"
            " 'stickslip[logs]'."
        ) from None

    class Json(DecoderFactory):
        @override
        def decoder_for(self, message_encoding: str, schema: Any) -> Callable[[bytes], Any] | None:
            return _from_json if message_encoding == "json" else None

    try:
        check_mcap(path)
        with path.open("rb") as file:
            reader = make_reader(file, decoder_factories=[Ros2(), Json()], validate_crcs=True)
            return table_of(_Mcap(str(path), reader), str(path), names)
    except InputError:
        raise
    except DecoderNotFoundError:
        raise InputError(
            f"{path}: its messages of ROS 2 are described in IDL, which is not decoded: convert it"
            " with `ros2 bag convert`."
        ) from None
    except McapError as error:
        reason = (str(error).strip() or type(error).__name__).splitlines()[0].rstrip(".")
        raise InputError(
            f"{path}: is not an MCAP file, or is damaged ({reason}): `mcap recover` of the MCAP"
            " command line saves what can be read."
        ) from None
    except Exception as error:
        # Decompression and decoding have whatever error their parsers stumble over.
        reason = (str(error).strip() or type(error).__name__).splitlines()[0].rstrip(".")
        raise InputError(f"{path}: is damaged, or has a message that is: {reason}.") from None


def _from_json(data: bytes) -> Any:
    if len(data) > LARGEST_JSON:
        raise ValueError(f"it has {len(data)} bytes of JSON, more than {LARGEST_JSON}")
    return json_of(data)


@final
class _Mcap(Log):
    """A file that is open."""

    def __init__(self, file: str, reader: Any) -> None:
        self.reader, self.file = reader, file
        summary = reader.get_summary()
        sizes: dict[int, int] = {}
        if summary is None or summary.statistics is None:
            channels, schemas = {}, {}
            for schema, channel, _ in reader.iter_messages():
                channels[channel.id] = channel
                schemas[channel.schema_id] = schema
                sizes[channel.id] = sizes.get(channel.id, 0) + 1
        else:
            channels, schemas = summary.channels, summary.schemas
            sizes = summary.statistics.channel_message_counts
        found: dict[str, Topic] = {}
        self.encodings: dict[str, str] = {}
        for number, channel in channels.items():
            schema = schemas.get(channel.schema_id)
            before = found[channel.topic].messages if channel.topic in found else 0
            found[channel.topic] = Topic(
                name=channel.topic,
                kind=schema.name if schema is not None else channel.message_encoding,
                messages=before + sizes.get(number, 0),
            )
            self.encodings[channel.topic] = channel.message_encoding
        self.topics: Sequence[Topic] = [*found.values()]

    @override
    def messages(self, topics: Collection[str]) -> Iterator[tuple[str, int, Any]]:
        other = [
            f"{one} ({self.encodings[one]})"
            for one in topics
            if self.encodings[one] not in ("cdr", "json")
        ]
        if other:
            raise InputError(
                f"{self.file}: messages of {joined(other)} cannot be decoded: those of ROS 2"
                " (cdr) and in JSON can."
            )
        for _, channel, message, decoded in self.reader.iter_decoded_messages(topics=topics):
            yield channel.topic, message.log_time, decoded
