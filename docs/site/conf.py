"""Sphinx's settings for the site: from Sphinx 5.3 with MyST 0.18 (Debian 12) to 8.1 with 4.0 (Debian 13)."""

import pathlib
import re
import sys
import types
import typing

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
html_css_files, html_js_files = ["site.css"], ["site.js"]
html_show_copyright = html_show_sphinx = html_copy_source = False
html_theme_options = {
    "navigation_with_keys": True,
    "light_css_variables": colours("#0b5c7a"),
    "dark_css_variables": colours("#7cc7e8"),
}
pygments_style, pygments_dark_style = "friendly", "monokai"
highlight_language = "none"  # of blocks without one: commands
nitpicky = True
smartquotes_action = "qe"  # no dashes: -- begins flags
toc_object_entries_show_parents = "hide"

myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 4
# A line that begins with "% of" is text.
myst_disable_syntax = ["myst_line_comment", "myst_block_break", "myst_target"]

suppress_warnings = ["myst.header"]  # tables that a script writes go from # to ###

# Types that have no page here.
nitpick_ignore_regex = [
    (r"cpp:identifier", r"std(::.*)?|wavepath|_?[a-z_]+_t"),
    (r"py:.*", r"(np|numpy|collections|os|pathlib|typing)\..*|NDArray|ArrayLike"),
    (r"py:.*", r"CameraArgument|Picture|ProgressArgument|(.*\.)?_?T"),
]

autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_preserve_defaults = True
autodoc_typehints_format = "short"
autodoc_type_aliases = {name: name for name in ("ArrayLike", "CameraArgument", "Picture", "ProgressArgument")}
python_use_unqualified_type_names = True


class NDArray(typing.Generic[typing.TypeVar("Scalar")]):
    """NumPy's, by its name alone."""
    __module__ = "numpy.typing"


def load_module():
    """Imports the Python module without what is compiled: its stub, python/wavepath/_core.pyi, stands in. Names stand
    in for NumPy, so that pages are the same where it is installed and where it is not."""
    def named(name):
        return type(name, (), {"__module__": "numpy", "__init__": lambda self, *values: None})

    sys.modules["numpy"] = types.ModuleType("numpy")
    sys.modules["numpy"].__getattr__ = named
    sys.modules["numpy.typing"] = types.ModuleType("numpy.typing")
    sys.modules["numpy.typing"].__dict__.update(NDArray=NDArray, ArrayLike=typing.Any)
    file = str(ROOT / "python" / "wavepath" / "_core.pyi")
    core = types.ModuleType("wavepath._core")
    core.__file__ = file
    core.version = version
    exec(compile(pathlib.Path(file).read_text(), file, "exec"), core.__dict__)
    sys.modules["wavepath._core"] = core
    import wavepath
    return set(wavepath.__all__)


PUBLIC = load_module()


def resolve_public(app, env, node, content):
    """`wavepath.scene.Scene` of an annotation is documented as `wavepath.Scene`."""
    module, _, name = node.get("reftarget", "").rpartition(".")
    if node.get("refdomain") == "py" and module.startswith("wavepath.") and name in PUBLIC:
        domain = env.get_domain("py")
        return domain.resolve_xref(env, node["refdoc"], app.builder, node["reftype"], f"wavepath.{name}", node, content)
    return None


def setup(app):
    app.connect("missing-reference", resolve_public)
