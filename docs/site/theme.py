"""Mends furo as Debian 12 and 13 package it, so that pages open from a disk: its script imports another one, which
browsers refuse there; its style sheet imports one of the web server's root; and it follows no wish for a dark page."""

import pathlib
import re

IMPORT = re.compile(r'^import (?:\* as )?Gumshoe from "\./gumshoe-patched\.js";\n')
FOLLOWS_WISH = re.compile(r'body:not\(\[data-theme="?light"?\]\)[^{}]*\{[^{}]*--color-background-primary')
DARK = re.compile(r'body\[data-theme="?dark"?\]\s*\{([^{}]*--color-background-primary[^{}]*)\}')


def mend_script(site):
    script, other = site / "_static/scripts/furo.js", site / "_static/scripts/gumshoe-patched.js"
    text = script.read_text(encoding="utf-8")
    if not IMPORT.match(text):
        return
    script.write_text(other.read_text(encoding="utf-8") + IMPORT.sub("", text), encoding="utf-8")  # of window.Gumshoe
    for page in site.rglob("*.html"):
        content = page.read_text(encoding="utf-8")
        page.write_text(content.replace('<script type="module" ', "<script "), encoding="utf-8")


def mend_style(sheet):
    text = sheet.read_text(encoding="utf-8")

    def imported(match):
        file = pathlib.Path("/usr/share" + match[1])
        return file.read_text(encoding="utf-8") if file.is_file() else ""

    mended = re.sub(r"@import url\((/[^)]*)\);", imported, text)
    if not FOLLOWS_WISH.search(mended) and (dark := DARK.search(mended)):
        mended += (f"\n@media not print {{ @media (prefers-color-scheme: dark) {{\n"
                   f'body:not([data-theme="light"]) {{{dark[1]}}} }} }}\n')
    if mended != text:
        sheet.write_text(mended, encoding="utf-8")


def mend(app, failure):
    if failure is None and app.builder.format == "html":
        mend_script(pathlib.Path(app.outdir))
        mend_style(pathlib.Path(app.outdir) / "_static" / "styles" / "furo.css")


def setup(app):
    app.connect("build-finished", mend)
    return {"version": "1", "parallel_read_safe": True}
