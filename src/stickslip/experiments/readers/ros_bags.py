"""Bags of ROS 2 and ROS 1."""

from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import Any, Final, final

from typing_extensions import override

from stickslip.errors import InputError
from stickslip.experiments.readers.table import Table
from stickslip.experiments.readers.topics import Log, Topic, table_of

BAGS: Final = (".db3", ".bag")
"""Endings of files of bags."""
PARTS: Final = ("*.db3*", "*.mcap*")
"""Files in the folder of a bag of ROS 2 that hold its messages, compressed or not."""
METADATA: Final = "metadata.yaml"
"""File in the folder of a bag of ROS 2 that lists the others."""


def read_bag(path: Path, names: Collection[str] = ()) -> Table:
    """Return the states of joints in a bag."""
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise InputError(
            f"{path}: ROS bags need the package rosbags: pip install 'stickslip[logs]'."
        ) from None
    whole = path.parent if path.name == METADATA else path
    try:
        # Bags of SQLite hold no definitions of messages before ROS 2 Iron.
        store = get_typestore(Stores.LATEST)
        with AnyReader([whole], default_typestore=store) as reader:
            return table_of(_Bag(reader), str(path), names)
    except InputError:
        raise
    except Exception as error:
        # The package has whatever error its parsers stumble over.
        reason = (str(error).strip() or type(error).__name__).splitlines()[0].rstrip(".")
        raise InputError(f"{path}: is not a ROS bag, or is damaged: {reason}.") from None


@final
class _Bag(Log):
    """A bag that is open."""

    def __init__(self, reader: Any) -> None:
        self.reader = reader
        found: dict[str, Topic] = {}
        for one in reader.connections:
            before = found[one.topic].messages if one.topic in found else 0
            found[one.topic] = Topic(
                name=one.topic, kind=one.msgtype, messages=before + one.msgcount
            )
        self.topics: Sequence[Topic] = [*found.values()]

    @override
    def messages(self, topics: Collection[str]) -> Iterator[tuple[str, int, Any]]:
        wanted = [one for one in self.reader.connections if one.topic in topics]
        for connection, logged, data in self.reader.messages(connections=wanted):
            yield connection.topic, logged, self.reader.deserialize(data, connection.msgtype)
