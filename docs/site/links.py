"""Links that the documents do not write: words of the glossary, flags and commands in running text."""

import re

from docutils import nodes
from sphinx.util.nodes import make_refnode

GLOSSARY = "docs/glossary"
# Words of the glossary that texts also use in their everyday sense.
EVERYDAY = set("""sample path slot entry pass frame band segment run capacity resolve emulate level quad net checkpoint
training cell cluster branches candidate stage cover picture blocked technique body plan cost work reuse environment
gain occlusion hierarchy panorama atlas film""".split()) | {"supported by"}
PAGE_LANGUAGES = {"docs/python": ("py", "wavepath."), "api/python": ("py", "wavepath."),
                  "docs/library": ("cpp", "wavepath::")}
VARIABLES = {"r": "Result", "scene": "Scene", "job": "Job"}  # of the examples in Python
PAGE_COMMANDS = {"docs/study": "study", "docs/window": "view", "docs/numerics": "selftest"}


def note_terms(app, doctree):
    """Makes each row of the glossary a place that can be linked, and its words findable."""
    if app.env.docname != GLOSSARY:
        return
    domain = app.env.get_domain("std")
    terms = app.env.wavepath_terms = {}
    for row in doctree.findall(nodes.row):
        cells = [cell.astext() for cell in row.children]
        if isinstance(row.parent, nodes.thead) or cells[0] in ("section",) or row.next_node(nodes.reference) in row[0]:
            continue
        words = [word.strip() for word in cells[0].split(", ")]
        anchor = "term-" + re.sub(r"\W+", "-", words[0].lower())
        row["ids"].append(anchor)
        for word in words:
            terms[word] = (anchor, cells[1])
            domain.note_object("term", word, anchor, location=row)


def is_prose(node):
    """True for text that may get links: not in links, code, titles and tables of contents."""
    while node is not None:
        if isinstance(node, (nodes.reference, nodes.literal, nodes.literal_block, nodes.title, nodes.raw, nodes.caption,
                             nodes.doctest_block, nodes.strong)) or node.tagname.startswith(("desc", "pending")):
            return False
        node = node.parent
    return True


def link_terms(app, doctree, docname):
    """The first mention of each word on a page leads to the glossary."""
    terms = getattr(app.env, "wavepath_terms", {})
    words = [word for word in terms if word not in EVERYDAY]
    patterns = {word: re.compile(rf"(?<![\w-]){re.escape(word)}s?(?![\w-])") for word in words}
    for text in [text for text in doctree.findall(nodes.Text) if is_prose(text.parent)]:
        pieces, rest = [], str(text)
        while patterns:
            found = [(match.start(), -len(word), word, match) for word, pattern in patterns.items()
                     if (match := pattern.search(rest))]
            if not found:
                break
            _, _, word, match = min(found, key=lambda one: one[:2])
            del patterns[word]
            anchor, meaning = terms[word]
            link = make_refnode(app.builder, docname, GLOSSARY, anchor, nodes.inline("", match[0]), meaning)
            link["classes"].append("term")
            pieces += [nodes.Text(rest[:match.start()]), link]
            rest = rest[match.end():]
        if pieces:
            text.parent.replace(text, [*pieces, nodes.Text(rest)])


def flag_target(app, docname, code):
    """Page and anchor of `--flag VALUE`, `wavepath COMMAND --flag` or `./run COMMAND`."""
    options = app.env.get_domain("std").progoptions
    named = re.match(r"(?:\./run|wavepath) (\w+)(?:.*?(?<![\w-])(--[a-z][a-z-]*))?", code)
    if named and f"commands/{named[1]}" in app.env.found_docs:
        return options.get((f"wavepath-{named[1]}", named[2]), (f"commands/{named[1]}", ""))
    flag = re.match(r"(?:(\w+) )?(--[a-z][a-z-]*|-[a-z])(?![\w-])", code)
    if not flag:
        return None
    for command in (flag[1], PAGE_COMMANDS.get(docname), "render", "view", "info", "study", "compare", "bench",
                    "selftest", "relight", "merge"):
        if (f"wavepath-{command}", flag[2]) in options:
            return options[f"wavepath-{command}", flag[2]]
    return None


def object_target(app, docname, code):
    """Page and anchor of `Scene.render`, `wavepath.Camera(eye=...)` or, in texts about C++, `Session`."""
    match = re.match(r"(?:wavepath(?:\.|::))?([A-Za-z]\w*(?:\.\w+)?)(?=\W|$)", code)
    if not match or docname not in PAGE_LANGUAGES or re.match(r"\w+ ?=", code):
        return None
    language, prefix = PAGE_LANGUAGES[docname]
    variable, dot, member = match[1].partition(".")
    name = prefix + VARIABLES.get(variable, variable) + dot + member
    is_one = "wavepath" in match[0] or match[1][0].isupper() or (variable in VARIABLES and member)
    return object_places(app, language).get(name) if is_one else None


def object_places(app, language):
    return {name: (page, anchor) for name, _, _, page, anchor, _ in app.env.get_domain(language).get_objects()}


def link_code(app, doctree, docname):
    """Code of a flag, a command or a class in running text leads to its description."""
    for code in list(doctree.findall(nodes.literal)):
        parents = []
        node = code.parent
        while node is not None:
            parents.append(node)
            node = node.parent
        if any(isinstance(one, (nodes.reference, nodes.title)) for one in parents):
            continue
        target = flag_target(app, docname, code.astext()) or object_target(app, docname, code.astext())
        if target:
            place, anchor = target
            link = make_refnode(app.builder, docname, place, anchor, code.deepcopy())
            link["classes"].append("flag")
            code.parent.replace(code, link)


def resolve(app, doctree, docname):
    if app.builder.format != "html":
        return
    if docname.startswith(("docs/", "README")) and docname != GLOSSARY:
        link_terms(app, doctree, docname)
    if docname.startswith(("docs/", "README", "index", "CONTRIBUTING", "api/")):
        link_code(app, doctree, docname)


def purge(app, env, docname):
    if docname == GLOSSARY:
        env.wavepath_terms = {}


def setup(app):
    app.connect("doctree-read", note_terms)
    app.connect("doctree-resolved", resolve)
    app.connect("env-purge-doc", purge)
    return {"version": "1", "env_version": 1, "parallel_read_safe": False}
