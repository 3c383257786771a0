"""Sphinx's settings for the site: from Sphinx 5.3 with MyST 0.18 (Debian 12) to 8.1 with 4.0 (Debian 13)."""

import importlib.machinery
import importlib.util
import pathlib
import re
import sys
import types

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path[:0] = [str(HERE), str(ROOT / "python")]



def colours(brand):
    names = {"color-brand-primary": brand, "color-brand-content": brand, "color-api-name": brand}
    return {**names, "color-api-pre-name": "var(--color-foreground-secondary)"}


project = "wavepath"
version = release = re.search(r"project\(wavepath VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
extensions = ["myst_parser", "sphinx.ext.autodoc", "links", "theme"]
html_theme = "furo"
html_title = f"wavepath {version}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_copyright = html_show_sphinx = html_copy_source = False
html_theme_options = {
    "navigation_with_keys": True,
    "light_css_variables": colours("#0b5c7a"),
    "dark_css_variables": colours("#7cc7e8"),
}
pygments_style, pygments_dark_style = "friendly", "monokai"
highlight_language = "none"  # of blocks without one: commands
nitpicky = True
toc_object_entries_show_parents = "hide"

myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 4

suppress_warnings = ["myst.header"]  # tables that a script writes go from # to ###

# Types that have no page here.
nitpick_ignore_regex = [
    (r"cpp:identifier", r"std(::.*)?|wavepath|_?[a-z_]+_t"),
    (r"py:.*", r"(np|numpy|collections|os|pathlib|typing)\..*|NDArray|ArrayLike|ProgressArgument|CameraArgument|Picture|T|_T|.*\._T"),
]

autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_preserve_defaults = True
autodoc_type_aliases = {name: name for name in ("ArrayLike", "CameraArgument", "Picture", "ProgressArgument")}
python_use_unqualified_type_names = True


def load_module():
    """Imports the Python module without what is compiled: its stub, python/wavepath/_core.pyi, stands in. So does a
    mock for NumPy, where it is not installed."""
    from sphinx.ext.autodoc.mock import _MockModule
    if importlib.util.find_spec("numpy") is None:
        for name in ("numpy", "numpy.typing"):
            sys.modules[name] = _MockModule(name)
    file = str(ROOT / "python" / "wavepath" / "_core.pyi")
    core = types.ModuleType("wavepath._core")
    core.__file__ = file
    core.version = version
    exec(compile(pathlib.Path(file).read_text(), file, "exec"), core.__dict__)
    sys.modules["wavepath._core"] = core
    import wavepath
    for name in wavepath.__all__:  # they are documented as wavepath.NAME, and linked by that name
        if hasattr(getattr(wavepath, name), "__module__"):
            getattr(wavepath, name).__module__ = "wavepath"


load_module()
