"""Fail if a built page would fetch anything from the network: python check_offline.py FOLDER."""

import re
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path

REMOTE = re.compile(r"\s*(https?:)?//", re.IGNORECASE)
CSS_REMOTE = re.compile(
    r"""(?:url\(\s*|@import\s+)["']?((?:https?:)?//[^"')\s;]+)""", re.IGNORECASE
)
CSS_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
FETCHED_LINKS = {"stylesheet", "preload", "modulepreload", "prefetch", "preconnect", "icon"}
"""Values of rel for which a browser fetches the address; others, such as canonical, are names."""


class Page(HTMLParser):
    """Collects the remote addresses that a browser would fetch to show a page."""

    def __init__(self) -> None:
        super().__init__()
        self.remote: list[str] = []
        self.in_style = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or "" for name, value in attrs}
        self.in_style = tag == "style"
        self.remote += CSS_REMOTE.findall(values.get("style", ""))
        self.remote += [url for url in fetched(tag, values) if REMOTE.match(url)]

    def handle_data(self, data: str) -> None:
        if self.in_style:
            self.remote += CSS_REMOTE.findall(CSS_COMMENT.sub("", data))


def fetched(tag: str, values: dict[str, str]) -> Iterator[str]:
    """Addresses that a browser fetches because of one tag."""
    if tag != "a":
        yield values.get("src", "")
        yield values.get("poster", "")
        yield from values.get("srcset", "").split(",")
    if tag == "object":
        yield values.get("data", "")
    if tag in {"image", "use"}:
        yield values.get("href", values.get("xlink:href", ""))
    if tag == "link" and FETCHED_LINKS & set(values.get("rel", "").lower().split()):
        yield values.get("href", "")


def remote_addresses(path: Path) -> list[str]:
    """Remote addresses that a page or a style sheet fetches."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".css":
        return CSS_REMOTE.findall(CSS_COMMENT.sub("", text))
    page = Page()
    page.feed(text)
    return page.remote


def main(folder: Path) -> str | None:
    paths = sorted([*folder.rglob("*.html"), *folder.rglob("*.css")])
    if not paths:
        return f"{folder} holds no page."
    found = [f"{path}: {address}" for path in paths for address in remote_addresses(path)]
    if found:
        return "\n".join(["Pages fetch from the network:", *found])
    print(f"{len(paths)} pages and style sheets need no network.")
    return None


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
