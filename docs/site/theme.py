"""Mends furo as Debian 12 packages it, so that pages open from a disk: its script imports another one, which browsers
refuse there; its style sheet imports one of the web server's root; and it follows no wish for a dark page."""

import pathlib
import re

IMPORTED = 'import Gumshoe from "./gumshoe-patched.js";\n'
DARK = re.compile(r'body\[data-theme="?dark"?\]\s*\{([^{}]*--color-background-primary[^{}]*)\}')


def mend_script(folder):
    script, other = folder / "furo.js", folder / "gumshoe-patched.js"
    text = script.read_text(encoding="utf-8")
    if IMPORTED in text:  # which defines window.Gumshoe
        script.write_text(other.read_text(encoding="utf-8") + text.replace(IMPORTED, ""), encoding="utf-8")


def mend_style(sheet):
    text = sheet.read_text(encoding="utf-8")

    def imported(match):
        file = pathlib.Path("/usr/share" + match[1])
        return file.read_text(encoding="utf-8") if file.is_file() else ""

    mended = re.sub(r"@import url\((/[^)]*)\);", imported, text)
    if "prefers-color-scheme" not in mended and (dark := DARK.search(mended)):
        mended += (f"\n@media not print {{ @media (prefers-color-scheme: dark) {{\n"
                   f'body:not([data-theme="light"]) {{{dark[1]}}} }} }}\n')
    if mended != text:
        sheet.write_text(mended, encoding="utf-8")


def mend(app, failure):
    if failure is None and app.builder.format == "html":
        mend_script(pathlib.Path(app.outdir) / "_static" / "scripts")
        mend_style(pathlib.Path(app.outdir) / "_static" / "styles" / "furo.css")


def setup(app):
    app.connect("build-finished", mend)
    return {"version": "1", "parallel_read_safe": True}
