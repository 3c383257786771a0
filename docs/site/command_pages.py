"""Pages of the commands, made of what the program prints for --help and --help-all."""

import re

import pages
from help_text import ask, commands_of, parse, read

EXAMPLE = re.compile(r"(?m)^(?:\./run|wavepath) +(\w+)\b.*$")
EXPERT = ":expert:`expert`"


def escaped(text):
    return re.sub(r"([\\*`|_])", r"\\\1", text)


def linked(text, flags, commands, choices=()):
    """reStructuredText with links to flags of the command, other commands and pages. `choices`: values of the flag."""
    def one(match):
        word = match[0]
        if word.startswith("docs/"):
            return f":doc:`/{word[:-3]}`"
        if word.startswith("'wavepath "):
            name = word.split(" ")[1].strip("'")
            return f":doc:`{escaped(word[1:-1])} </commands/{name}>`" if name in commands else f"``{word[1:-1]}``"
        if word.startswith("-"):
            return f":option:`{word}`" if word in flags else f"``{word}``"
        return f"``{word}``"

    pattern = r"docs/[\w-]+\.md|'wavepath [^']+'|(?<![\w-])--?[a-z][a-z-]*"
    pattern += r"|(?<![\w.])\.(?:exr|hdr|png|jpg|gltf|glb|json)\b|(?:~|\$[A-Z_]+)/[\w./]*\w|[A-Z_]{9,}=\w+"
    if choices:
        pattern += rf"|(?<![\w-])(?:{'|'.join(map(re.escape, choices))})(?=:)"
    parts, last = [], 0
    for match in re.finditer(pattern, text):
        before = "\\ " if re.search(r"[\w/+]$", text[:match.start()]) else ""
        behind = "\\ " if re.match(r"\w", text[match.end():]) else ""
        parts += [escaped(text[last:match.start()]), before, one(match), behind]
        last = match.end()
    return "".join([*parts, escaped(text[last:])])


def examples_of(stage, command):
    """Lines of the documents that use the command, each with its page; the first of each page come first."""
    found, seen = [], set()
    for page in pages.discover(stage.root):
        if not page.startswith("docs/") and page != "README.md":
            continue
        lines = []
        for fence in pages.FENCE.findall(stage.text(page)):
            lines += [m[0].split("  #")[0].strip() for m in EXAMPLE.finditer(fence) if m[1] == command]
        found += [(rank, page, line) for rank, line in enumerate(lines)]
    chosen = []
    for _, page, line in sorted(found, key=lambda one: one[0]):
        if line not in seen:
            seen.add(line)
            chosen.append((page, line))
    return chosen


def capital(text):
    return text[:1].upper() + text[1:]


def heading(text, mark):
    return [text, mark * len(text), ""]


def page_of(stage, program, command, commands):
    parsed = read(program, command)
    flags = {name for flag in parsed.flags() for name in flag.names()}
    title = f"wavepath {command}"
    lines = [".. role:: expert", "", *heading(title, "="), f"{escaped(capital(parsed.about))}.", "",
             ".. code-block:: text", "", f"   {parsed.usage}", "", f".. program:: {title}", ""]
    own, ends = [], []
    for paragraph in parsed.end:
        general = re.match(r"'wavepath COMMAND --help'|These are all flags|'wavepath \w+ --help-all' shows", paragraph)
        if not general:
            ends += [linked(paragraph, flags, commands), ""]
    experts = sum(flag.is_expert for flag in parsed.flags())
    if experts:
        own = [f"The {experts} flags that are marked {EXPERT} are those of ``--help-all``; the others are shown by "
               "``--help`` too. :doc:`index` tells exit codes and what all commands share.", ""]
    lines += ends + own
    examples = examples_of(stage, command)
    if examples:
        lines += [*heading("Examples", "-"), ".. code-block:: text", ""]
        lines += [*(f"   {line}" for _, line in examples[:8]), ""]
        sources = {page: pages.title_of(stage, page) for page, _ in examples[:8]}
        links = (f":doc:`{title} </{pages.document_name(page)}>`" for page, title in sources.items())
        lines += [f"They are explained in {', '.join(links)}.", ""]
    for group, members in parsed.groups:
        lines += heading(escaped(group), "-")
        for flag in members:
            lines += [f".. option:: {flag.head}", ""]
            others = flags - set(flag.names())
            text = linked(flag.text, others, commands, flag.choices())
            lines += [f"   {capital(text)}{'' if text.endswith('.') else '.'}", ""]
            initial = linked(flag.default, others, commands)
            if re.fullmatch(r"[\w.,/-]+", flag.default):
                initial = f"``{flag.default}``"
            facts = [f"Default: {initial}"] if flag.default else []
            facts += [EXPERT] if flag.is_expert else []
            if facts:
                lines += [f"   {' '.join(facts)}", ""]
    return "\n".join(lines)


def table(*heads):
    rows = [f"{'     -' if i else '   * -'} {head}" for i, head in enumerate(heads)]
    return [".. list-table::", "   :header-rows: 1", "   :widths: 22 78", "", *rows]


def index_of(program, commands):
    whole = parse(ask(program, "--help"))
    lines = [*heading("Commands and flags", "="),
             f"{escaped(capital(whole.about))}. ``./run COMMAND`` in the folder of wavepath is "
             "``wavepath COMMAND`` after a build.", "", *table("command", "what it does")]
    for name, about in commands:
        lines += [f"   * - :doc:`{name} </commands/{name}>`", f"     - {escaped(about)}"]
    lines += ["", *heading("Exit codes, help and caches", "-")]
    for paragraph in whole.end:
        before, _, rest = paragraph.partition(" Exit codes: ")
        codes, _, behind = rest.partition(". ")
        lines += [linked(before, set(), {}), ""]
        if codes:
            lines += table("exit code", "meaning")
            for code in re.split(r", (?=\d+ )", codes):
                number, meaning = code.split(" ", 1)
                lines += [f"   * - ``{number}``", f"     - {linked(meaning, set(), {})}"]
            lines += ["", linked(behind, set(), {}), ""]
    lines += [".. toctree::", "   :hidden:", "", *(f"   {name}" for name, _ in commands), ""]
    return "\n".join(lines)


def write(stage, program):
    commands = commands_of(program)
    stage.write("commands/index.rst", index_of(program, commands))
    for name, _ in commands:
        stage.write(f"commands/{name}.rst", page_of(stage, program, name, dict(commands)))
