"""Put built pages beside those of other versions: python -m tools.site BUILT SITE VERSION.

Copies them to SITE/VERSION, and writes what is of all versions: a first page that leads to the
newest release, a list of versions, a page for addresses that lead nowhere, and a map of the newest
release for search engines, if ``--address`` says where the site is. Fails before it writes anything
if a link inside the pages leads nowhere; ``--check`` only looks for such links.
"""

import argparse
import shutil
import sys
from collections.abc import Iterator
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit
from xml.sax.saxutils import escape

DEVELOPMENT = "dev"
PAGE = """<!doctype html>
<html lang="en">
<head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>{head}
<style>body {{ font-family: sans-serif; max-width: 40em; margin: 3em auto; padding: 0 1em }}</style>
</head>
<body>
<h1>{title}</h1>
{body}
</body>
</html>
"""


class Links(HTMLParser):
    """Collects what a page leads to, and the places in it that can be led to."""

    def __init__(self) -> None:
        super().__init__()
        self.targets: list[str] = []
        self.places: set[str] = set()

    def handle_starttag(self, _tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or "" for name, value in attrs}
        self.places.update(values[name] for name in ("id", "name") if values.get(name))
        self.targets += [values[name] for name in ("href", "src") if values.get(name)]


@cache
def links_of(page: Path) -> Links:
    result = Links()
    result.feed(page.read_text(encoding="utf-8"))
    return result


def broken(built: Path) -> Iterator[str]:
    """Yield links inside built pages that lead nowhere."""
    for page in sorted(built.rglob("*.html")):
        for target in dict.fromkeys(links_of(page).targets):
            parts = urlsplit(target)
            if parts.scheme or parts.netloc:
                continue
            path = page if not parts.path else (page.parent / unquote(parts.path)).resolve()
            path = path / "index.html" if path.is_dir() else path
            name = page.relative_to(built)
            if not path.is_file():
                yield f"{name}: {target} is not there"
                continue
            inside = parts.fragment and path.suffix == ".html"
            if inside and unquote(parts.fragment) not in links_of(path).places:
                yield f"{name}: {target} has no such place"


def order(version: str) -> tuple[int, ...]:
    """Sort releases by their numbers; what is no release comes before all."""
    numbers = version.split(".")
    return tuple(map(int, numbers)) if all(number.isdecimal() for number in numbers) else ()


def versions(site: Path) -> list[str]:
    """Return the folders of versions, the newest release first."""
    folders = [item.name for item in site.iterdir() if (item / "index.html").is_file()]
    return sorted(folders, key=order, reverse=True)


def front(site: Path, address: str) -> None:
    """Write the pages of all versions."""
    known = versions(site)
    newest = known[0]
    items = "\n".join(f'<li><a href="{item}/index.html">{item}</a></li>' for item in known)
    listed = f"<ul>\n{items}\n</ul>"
    leads = f'\n<meta http-equiv="refresh" content="0; url={newest}/index.html">'
    base = f'\n<base href="{address.rstrip("/")}/">' if address else ""
    lost = (
        f'<p>There is no such page. <a href="{newest}/search.html">Search</a> the documentation of'
        f" {newest}, or begin at a version:</p>\n{listed}"
    )
    pages = {
        "index.html": PAGE.format(title="stickslip", head=leads, body=listed),
        "versions.html": PAGE.format(title="Versions of stickslip", head="", body=listed),
        # a server sends it for an address of any depth
        "404.html": PAGE.format(title="Not found", head=base, body=lost),
        ".nojekyll": "",
    }
    if address:
        here = f"{address.rstrip('/')}/{newest}/"
        names = sorted(item.relative_to(site / newest) for item in (site / newest).rglob("*.html"))
        urls = "\n".join(
            f"<url><loc>{escape(here + item.as_posix())}</loc></url>" for item in names
        )
        space = "http://www.sitemaps.org/schemas/sitemap/0.9"
        pages["sitemap.xml"] = (
            f'<?xml version="1.0" encoding="UTF-8"?>\n<urlset xmlns="{space}">\n{urls}\n</urlset>\n'
        )
        pages["robots.txt"] = f"Sitemap: {address.rstrip('/')}/sitemap.xml\n"
    for name, text in pages.items():
        (site / name).write_text(text, encoding="utf-8")


def main() -> str | None:
    parser = argparse.ArgumentParser(prog="python -m tools.site", description=__doc__)
    parser.add_argument("built", type=Path)
    parser.add_argument("site", type=Path, nargs="?")
    parser.add_argument("version", nargs="?", default=DEVELOPMENT)
    parser.add_argument("--address", default="", help="where the site will be, such as https://...")
    parser.add_argument("--check", action="store_true", help="only look for broken links")
    asked = parser.parse_args()
    wrong = [*broken(asked.built.resolve())]
    if wrong:
        return "\n".join(["Links lead nowhere:", *wrong])
    print(f"{len([*asked.built.rglob('*.html')])} pages have no link that leads nowhere inside.")
    if asked.check:
        return None
    if asked.site is None:
        return "Name the folder of the site, or give --check."
    target = asked.site / asked.version
    if target.exists():
        shutil.rmtree(target)
    shutil.copytree(asked.built, target, ignore=shutil.ignore_patterns(".doctrees", ".buildinfo"))
    front(asked.site, asked.address)
    return None


if __name__ == "__main__":
    sys.exit(main())
