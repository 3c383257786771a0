"""Markdown pages of the repository, for the site: which they are, where their links lead, and how they are arranged."""

import dataclasses
import json
import pathlib
import posixpath
import re

import drawings

START = "docs/README.md"  # its tables become the front page and the navigation
GALLERY = "benchmarks/results/gallery/README.md"
TITLES = {START: "The front page", "README.md": "Overview and installation"}  # where a page has another one
LINK = re.compile(r"(?<!\!)\[([^\[\]]*)\]\(([^)#\s]*)(?:#([^)\s]+))?\)")
PICTURE = re.compile(r"!\[([^\]]*)\]\(([^)\s]+)\)")
FENCE = re.compile(r"(?ms)^( *```.*?^ *```)$")
SHOWN = {".cpp": "cpp", ".h": "cpp", ".py": "python", ".sh": "bash", "": "text", ".txt": "text"}  # on a page


@dataclasses.dataclass
class Stage:
    """The folder that Sphinx reads."""
    root: pathlib.Path
    folder: pathlib.Path

    def write(self, name, content):
        file = self.folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content if isinstance(content, bytes) else content.encode())

    def copy(self, name):
        self.write(name, (self.root / name).read_bytes())

    def text(self, name):
        return (self.root / name).read_text(encoding="utf-8")


def slug(title):
    """Anchor of a heading, as GitHub and MyST name it."""
    return re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-")


def headings(text):
    return re.findall(r"(?m)^#+ +(.*)$", FENCE.sub("", text))


def plain(markdown):
    return re.sub(r"[`*]", "", markdown)


def short(title):
    """A title without what stands behind its colon."""
    return plain(title).split(": ")[0]


def title_of(stage, page, anchor=None):
    """Short title of a page, or of its section."""
    if page in TITLES and not anchor:
        return TITLES[page]
    titles = headings(stage.text(page))
    return short(next((title for title in titles if slug(title) == anchor), titles[0]))


def target_of(page, link):
    """The file in the repository that a link of a page means."""
    return posixpath.normpath(posixpath.join(posixpath.dirname(page), link)) if link else page


def discover(root):
    """Pages that can be reached from the front page, in the order in which they are found."""
    found = [START, "README.md"]
    for page in found:
        for _, link, _ in LINK.findall(FENCE.sub("", (root / page).read_text(encoding="utf-8"))):
            target = target_of(page, link)
            if (root / target).is_dir():
                target = f"{target}/README.md"
            if target.endswith(".md") and (root / target).is_file() and target not in found:
                found.append(target)
    return found


def relative(page, target):
    return posixpath.relpath(target, posixpath.dirname(page) or ".")


def place_of(target):
    """The page of the site that shows a file."""
    return "index.md" if target == START else target


def link_of(stage, pages, page, match):
    """A link between files of the repository as one between pages of the site. Names of files become titles."""
    text, link, anchor = match.groups()
    if ":" in link:
        return match.group(0)
    target = target_of(page, link)
    if (stage.root / target).is_dir():
        inside = f"{target}/README.md"
        target = inside if inside in pages else list_folder(stage, target)
    elif target not in pages and pathlib.Path(target).suffix in SHOWN:
        target = show_source(stage, target)
    elif target not in pages:
        stage.copy(target)
    if target in pages:
        if text.endswith(".md") or text == link:
            text = title_of(stage, target, anchor)
    place = relative(place_of(page), place_of(target))
    return f"[{text}]({place}{'#' + anchor if anchor else ''})"


def show_source(stage, name):
    """A page with the source of a file; returns its name."""
    page = f"files/{name}.md"
    language = SHOWN[pathlib.Path(name).suffix]
    stage.write(page, f"---\norphan: true\n---\n# {name}\n\n`````{{code-block}} {language}\n{stage.text(name)}`````\n")
    return page


def list_folder(stage, folder):
    """A page with links to the files of a folder that has no page of its own; returns its name."""
    page = f"files/{folder}.md"
    lines = [f"---\norphan: true\n---\n# {folder}\n"]
    for file in sorted((stage.root / folder).iterdir()):
        name = str(file.relative_to(stage.root))
        stage.copy(name)
        lines.append(f"- [{file.name}]({relative(page, name)})")
    stage.write(page, "\n".join(lines) + "\n")
    return page


def adapted(stage, pages, page, text):
    """The text of a page with links, pictures and drawings of the site."""
    def picture(match):
        target = target_of(page, match[2])
        stage.copy(target)
        return f"![{match[1]}]({relative(place_of(page), target)})"

    parts = FENCE.split(text)
    for i, part in enumerate(parts):
        if part.lstrip().startswith("```mermaid"):
            name = f"{pathlib.PurePosixPath(page).with_suffix('')}-{i}.svg"

            def write(svg):
                stage.write(name, svg)
                return posixpath.basename(name)

            parts[i] = drawings.fence("\n".join(part.strip().split("\n")[1:-1]), write)
        elif not part.lstrip().startswith("```"):
            part = PICTURE.sub(picture, part)
            parts[i] = LINK.sub(lambda match: link_of(stage, pages, page, match), part)
    return "".join(parts)


def toctree(*entries, caption=None):
    lines = ["```{toctree}", ":hidden:", *([f":caption: {caption}"] if caption else []), ""]
    return "\n".join([*lines, *entries, "```", ""])


def document_name(page):
    return str(pathlib.PurePosixPath(place_of(page)).with_suffix(""))


def front_page(stage, pages):
    """The hand-written beginning, the tables of docs/README.md, and the navigation, which follows these tables."""
    start = adapted(stage, pages, START, stage.text(START))
    body = start[start.index("\n## ") + 1:]
    front = stage.text("docs/site/front.md")
    for name in re.findall(r"(?m)^```\{figure\} (\S+)$", front):
        stage.copy(name)
    listed = {START, "README.md", GALLERY, "docs/glossary.md", "docs/python.md", "docs/library.md"}
    trees = [toctree(f"{TITLES['README.md']} <README>", f"Gallery <{document_name(GALLERY)}>", caption="Start"),
             toctree("Python guide <docs/python>", "Python API <api/python>", "C++ guide <docs/library>",
                     "C++ API <api/cpp>", "Commands and flags <commands/index>", "Glossary <docs/glossary>",
                     "Index of names and flags <genindex>", caption="Reference")]
    for section in stage.text(START).split("\n## ")[1:]:
        caption = section.split("\n")[0]
        entries = []
        for _, link, _ in LINK.findall(section):
            target = target_of(START, link)
            if target in pages and target not in listed:
                listed.add(target)
                entries.append(f"{title_of(stage, target)} <{document_name(target)}>")
        trees.insert(-1, toctree(*entries, caption=caption))
    trees[-2:] = reversed(trees[-2:])  # the last section is for those who change the program
    return f"{front}\n{body}\n{''.join(trees)}", listed


def gallery_page(stage):
    """Of the table that benchmarks/gallery.py writes, and of the pictures of documents, with their pages."""
    text = stage.text(GALLERY)
    folder = posixpath.dirname(GALLERY)
    about = " ".join(line for line in text.split("\n## ")[0].split("\n")[1:] if not line.startswith("|"))
    lines = ["# Gallery", "", f"{about.strip()} A picture leads to its full size.", ""]
    rows = re.findall(r"(?m)^\| !\[(\w+)\]\((\S+)\) \| (.*?) \| `(.*?)` \| (.*?) \| (.*?) \| (.*?) \|$", text)
    for name, file, what, command, seconds, samples, error in rows:
        stage.copy(f"{folder}/{file}")
        lines += [f"## {what[0].upper()}{what[1:]}", "", f"```{{figure}} {file}", ":width: 100%",
                  f":alt: {json.dumps(what)}", "",
                  f"{float(seconds):.0f} s of rendering, {samples} samples a pixel; error {error} before the filter",
                  "```", "", "```", command, "```", ""]
    lines += ["## Pictures of the pages", "", "Each leads to the page that explains it.", "", ":::{container} pictures"]
    for page in sorted(name for name in discover(stage.root) if name.startswith("docs/") and name != START):
        for alt, file in PICTURE.findall(FENCE.sub("", stage.text(page))):
            target = target_of(page, file)
            stage.copy(target)
            place = relative(GALLERY, target)
            lines += [f"```{{figure}} {place}", f":alt: {json.dumps(' '.join(alt.split()))}", "",
                      f"[{' '.join(plain(alt).split())}]({relative(GALLERY, page)})", "```", ""]
    return "\n".join([*lines, ":::", ""])


def parent_of(page):
    """The page below which one stands in the navigation that docs/README.md does not name."""
    for parent in ("benchmarks/results/README.md", "scenes/README.md"):
        if page != parent and page.startswith(posixpath.dirname(parent)):
            return parent
    return "README.md"


def write(stage):
    pages = discover(stage.root)
    front, listed = front_page(stage, pages)
    stage.write("index.md", front)
    children = {}
    for page in pages:
        if page not in listed:
            children.setdefault(parent_of(page), []).append(page)
    for page in pages:
        if page == START:
            continue
        text = gallery_page(stage) if page == GALLERY else adapted(stage, pages, page, stage.text(page))
        below = [f"/{document_name(child)}" for child in children.get(page, [])]
        if below:
            text += "\n" + toctree(*below)
        if page.endswith("NOTES.md"):  # every word of the field is in it
            text = f"---\nnosearch: true\n---\n{text}"
        stage.write(page, text)
    stage.write("api/python.rst", stage.text("docs/site/python_api.rst"))
