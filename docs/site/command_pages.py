"""Pages of the commands, made of what the program prints for --help and --help-all."""

import dataclasses
import re
import subprocess

import pages

COLUMN = 30  # where the texts of --help begin
EXAMPLE = re.compile(r"(?m)^(?:\./run|wavepath) +(\w+)\b.*$")
EXPERT = ":expert:`expert`"


@dataclasses.dataclass
class Flag:
    head: str  # "-o, --output FILE"
    text: str
    default: str
    is_expert: bool = False

    def names(self):
        return [word.split(" ")[0] for word in self.head.split(", ")]

    def choices(self):
        values = self.head.split(", ")[-1].partition(" ")[2].split("|")
        return values if len(values) > 1 else []


@dataclasses.dataclass
class Help:
    about: str
    usage: str
    groups: list  # of (heading, flags)
    end: list  # paragraphs

    def flags(self):
        return [flag for _, flags in self.groups for flag in flags]


def parse(text):
    first, usage, *blocks = text.strip().split("\n\n")
    result = Help(first.split(": ", 1)[1], usage.removeprefix("Usage: "), [], [])
    for block in blocks:
        lines = block.split("\n")
        if len(lines) > 1 and lines[1].startswith("  "):
            result.groups.append((lines[0], parse_flags(lines[1:])))
        else:
            result.end.append(" ".join(lines))
    return result


def parse_flags(lines):
    flags = []
    for line in lines:
        if line.startswith(" " * COLUMN):
            flags[-1].text += " " + line.strip()
        elif len(line) > COLUMN and line[COLUMN - 2:COLUMN] == "  ":
            flags.append(Flag(line[:COLUMN].strip(), line[COLUMN:], ""))
        else:
            flags.append(Flag(line.strip(), "", ""))
    for flag in flags:
        if match := re.fullmatch(r"(.*) \[default: (.*)\]", flag.text.strip()):
            flag.text, flag.default = match.groups()
        flag.text = flag.text.strip()
    return flags


def ask(program, *words):
    return subprocess.run([program, *words], capture_output=True, text=True, check=True).stdout


def commands_of(program):
    """Names and descriptions, in the order of the program."""
    groups = dict(parse(ask(program, "--help")).groups)
    return [(flag.head, flag.text) for flag in groups["Commands"]]


def read(program, command):
    result, usual = parse(ask(program, command, "--help-all")), parse(ask(program, command, "--help"))
    shown = {flag.head for flag in usual.flags()}
    for flag in result.flags():
        flag.is_expert = flag.head not in shown
    return result


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
             ".. code-block:: text", "", f"   {parsed.usage}", ""]
    own, ends = [], []
    for paragraph in parsed.end:
        general = re.match(r"'wavepath COMMAND --help'|These are all flags|'wavepath \w+ --help-all' shows", paragraph)
        if not general:
            ends += [linked(paragraph, flags, commands), ""]
    experts = sum(flag.is_expert for flag in parsed.flags())
    if experts:
        own = [f"The {experts} flags that are marked {EXPERT} are those of ``--help-all``; the others are shown by "
               "``--help`` too. :doc:`index` tells exit codes and what all commands share.", ""]
    lines += ends + own + [f".. program:: {title}", ""]
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
