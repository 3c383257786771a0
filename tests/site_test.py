#!/usr/bin/env python3
"""The documentation site builds without a warning, is whole and opens from a disk; the examples of the documents work.
Usage: site_test.py SOURCE_DIR WAVEPATH_BINARY COMPILER. Ends with 77 where Sphinx, MyST, furo or Graphviz is missing;
examples are checked all the same."""

import ast
import html.parser
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest
import urllib.parse

ROOT = pathlib.Path(sys.argv[1]).resolve()
WAVEPATH, COMPILER = pathlib.Path(sys.argv[2]).resolve(), sys.argv[3]
DOCUMENTS = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "scenes/README.md")]
DOCUMENTS += [*sorted((ROOT / "docs").glob("*.md")), ROOT / "docs" / "site" / "front.md"]
GALLERY = ROOT / "benchmarks" / "results" / "gallery" / "README.md"
FENCE = re.compile(r"(?ms)^```([^\n]*)\n(.*?)^```$")
COMMAND = re.compile(r"(?:^(?:\w+=\S+ )*(?:\$ )?|`)(?:\./run|wavepath) +([a-z](?:[^#\n`;|&]|(?<=\S)#)*)", re.M)
OF_THE_LAUNCHER = ("python", "test", "setup", "format", "site")


def name(file):
    return str(file.relative_to(ROOT))


def fences(file):
    """Blocks of code, with their language."""
    return FENCE.findall(file.read_text(encoding="utf-8"))


def flat(text):
    """Letters and digits alone."""
    return re.sub(r"[^a-z0-9]", "", text.lower())


def printed(*words):
    return subprocess.run([WAVEPATH, *words], capture_output=True, text=True, check=True).stdout


def commands():
    return re.findall(r"(?m)^  ([a-z]+)  ", printed("--help").split("\nHelp")[0].split("Commands\n")[1])


class Examples(unittest.TestCase):
    def test_commands_are_understood(self):
        """Each is run where its scene is missing, or its device: then a flag or a value that does not exist ends it
        with the exit code of wrong usage, and nothing is rendered."""
        environment = {**os.environ, "VK_DRIVER_FILES": os.devnull, "VK_ICD_FILENAMES": os.devnull}
        environment.pop("DISPLAY", None)
        checked = set()
        with tempfile.TemporaryDirectory() as folder:
            for document in [*DOCUMENTS, GALLERY]:
                for line in COMMAND.findall(document.read_text(encoding="utf-8").replace("ASSETS/", "assets/")):
                    line = re.sub(r" >+ ?\S+$", "", line)  # what is printed goes into a file
                    words = shlex.split(line.replace("$", "").replace("tile_*", "tile_0.exr tile_1"))
                    about_values = re.search(r"(?<![\w.%/])[A-Z][A-Z:,]*(?![\w.=])|\.\.\.|\[", line)
                    if words[0] in OF_THE_LAUNCHER or len(words) == 1 or about_values or tuple(words) in checked:
                        continue
                    checked.add(tuple(words))
                    with self.subTest(document=name(document), line=line):
                        done = subprocess.run([WAVEPATH, *words], cwd=folder, env=environment, capture_output=True,
                                              text=True, check=False, timeout=60)
                        self.assertIn(done.returncode, (0, 1), done.stderr)
            self.assertEqual(os.listdir(folder), [])
        self.assertGreater(len(checked), 80)

    def test_shell_can_read_them(self):
        for document in DOCUMENTS:
            for language, block in fences(document):
                if language or re.match(r"wavepath: |\w+\(\)", block):  # what a program prints, a list of functions
                    continue
                with self.subTest(document=name(document), block=block):
                    done = subprocess.run(["bash", "-n"], input=block, capture_output=True, text=True, check=False)
                    self.assertEqual(done.stderr, "")

    def test_scripts_know_their_flags(self):
        checked = 0
        for document in DOCUMENTS:
            for _, block in fences(document):
                for script, line in re.findall(r"(?m)^((?:scenes|benchmarks)/\w+\.(?:py|sh))\b([^#\n]*)", block):
                    with self.subTest(document=name(document), script=script):
                        done = subprocess.run([ROOT / script, "--help"], capture_output=True, text=True, check=False)
                        for flag in re.findall(r"(?<!\S)--[\w-]+", line):
                            self.assertIn(flag, done.stdout + done.stderr)
                        self.assertTrue((ROOT / script).is_file())
                        checked += 1
        self.assertGreater(checked, 3)

    def test_python_and_cpp_are_run_by_other_tests(self):
        """Blocks of Python stand in docs/python.md alone, whose blocks tests/python/typing_test.py runs in turn; C++ is
        compiled here."""
        blocks = {}
        for document in DOCUMENTS:
            for language, block in fences(document):
                blocks.setdefault(language, []).append((name(document), block))
        languages = {language for language in blocks if not language.startswith("{")}  # but for directives
        self.assertEqual(languages - {"", "python", "cpp", "mermaid"}, set(), "a language that nothing checks")
        run = (ROOT / "docs" / "python.md").read_text(encoding="utf-8").split("```python\n")[1:]
        self.assertEqual([("docs/python.md", block.split("```")[0]) for block in run], blocks["python"])
        test = (ROOT / "tests" / "python" / "typing_test.py").read_text(encoding="utf-8")
        self.assertIn('ROOT / "docs" / "python.md"', test)
        modules = (ROOT / "python" / "wavepath").glob("*.py")
        with_examples = {file.stem for file in modules if ">>> " in file.read_text()}
        listed = set(re.search(r'"module", \[(.*?)\]', test)[1].replace('"', "").split(", "))
        self.assertLessEqual(with_examples - {"__init__"}, listed)
        for document, block in blocks["cpp"]:
            with self.subTest(document=document):
                lines = block.split("\n")
                includes = [line for line in lines if line.startswith("#include")]
                rest = [line for line in lines if not line.startswith("#include")]
                code = "\n".join([*includes, "int main() {", *rest, "}"])
                done = subprocess.run([COMPILER, "-std=c++17", "-Wall", "-Werror", f"-I{ROOT}/include", "-fsyntax-only",
                                       "-x", "c++", "-"], input=code, capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 0, done.stderr)


class Page(html.parser.HTMLParser):
    """What a page of the site has: anchors, links, and files that a browser loads for it."""

    def __init__(self, file):
        super().__init__()
        self.ids, self.links, self.loads, self.words, self.classes = set(), [], [], [], []
        self.silent, self.has_module = 0, False
        self.feed(file.read_text(encoding="utf-8"))
        self.text = flat(" ".join(self.words))

    def handle_starttag(self, tag, attributes):
        about = dict(attributes)
        self.ids.update(about[key] for key in ("id", "name") if about.get(key))
        self.has_module |= tag == "script" and about.get("type") == "module"
        self.classes += (about.get("class") or "").split()
        if tag == "a" and "href" in about:
            self.links.append(about["href"])
        elif tag == "link" and about.get("rel") in ("stylesheet", "icon", "preload"):
            self.loads.append(about["href"])
        elif tag == "link" and "href" in about:
            self.links.append(about["href"])
        self.loads += [about[key] for key in ("src", "srcset", "poster", "data") if about.get(key)]
        self.loads += style_loads(about.get("style") or "")
        self.silent += tag in ("script", "style")

    def handle_endtag(self, tag):
        self.silent -= tag in ("script", "style")

    def handle_data(self, data):
        if not self.silent:
            self.words.append(data)


def style_loads(style):
    found = re.findall(r"url\(\s*['\"]?([^'\")]+)|@import\s+['\"]([^'\"]+)", style)
    return [file for pair in found for file in pair if file and not file.startswith(("data:", "#"))]


class Site(unittest.TestCase):
    python = None  # one that has Sphinx

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.out = pathlib.Path(cls.folder.name) / "site"
        done = subprocess.run([cls.python, "-B", ROOT / "docs" / "site" / "build.py", "--program", WAVEPATH, "--out",
                               cls.out, "--strict"], capture_output=True, text=True, check=False)
        if done.returncode or done.stderr:
            raise AssertionError(done.stderr or done.stdout)
        cls.pages = {str(file.relative_to(cls.out)): Page(file) for file in cls.out.rglob("*.html")}

    def has(self, one, them):
        """assertIn, whose message holds a whole page."""
        self.assertTrue(one in them, f"'{one}' is missing")

    def resolved(self, page, link):
        """File of the site, and anchor."""
        place, _, anchor = link.partition("#")
        place = urllib.parse.unquote(place.partition("?")[0])
        file = os.path.normpath(os.path.join(os.path.dirname(page), place)) if place else page
        return file, urllib.parse.unquote(anchor)

    def test_links_lead_somewhere(self):
        count = 0
        for page, content in self.pages.items():
            for link in content.links:
                if re.match(r"(https?|mailto):", link):
                    continue
                file, anchor = self.resolved(page, link)
                count += 1
                with self.subTest(page=page, link=link):
                    self.assertTrue((self.out / file).is_file())
                    if anchor:
                        self.has(anchor, self.pages[file].ids)
        self.assertGreater(count, 5000)

    def test_loads_nothing_from_elsewhere(self):
        """No other host, no root of a server, and no module, which browsers refuse on a disk."""
        for page, content in self.pages.items():
            for link in content.loads:
                if link.startswith("data:"):
                    continue
                with self.subTest(page=page, link=link):
                    self.assertNotRegex(link, r"^(\w+:|/)")
                    self.assertTrue((self.out / self.resolved(page, link)[0]).is_file())
        for file in self.out.rglob("*.css"):
            for link in style_loads(re.sub(r"/\*.*?\*/", "", file.read_text(encoding="utf-8"), flags=re.S)):
                with self.subTest(file=file.name, link=link):
                    self.assertNotRegex(link, r"^(\w+:|/)")
                    self.assertTrue((file.parent / self.resolved("", link)[0]).is_file())
        for file in self.out.rglob("*.js"):
            with self.subTest(file=file.name):
                script = file.read_text(encoding="utf-8")
                self.assertNotRegex(script, r"(?m)^(import|export) |\bimport\(|fetch\(['\"]http")
        self.assertEqual([name for name, content in self.pages.items() if content.has_module], [])

    def test_pages_are_dark_on_request(self):
        sheet = (self.out / "_static" / "styles" / "furo.css").read_text(encoding="utf-8")
        of_the_browser = sheet[sheet.rindex("prefers-color-scheme"):]
        rule = r'body:not\(\[data-theme="?light"?\]\)[^{}]*\{[^{}]*--color-background-primary'
        self.assertRegex(of_the_browser, rule)

    def test_every_document_is_there(self):
        for document in [*DOCUMENTS[:-1], ROOT / "CHANGELOG.md", *(ROOT / "benchmarks" / "results").rglob("*.md")]:
            page = name(document.with_suffix(".html"))
            with self.subTest(document=name(document)):
                if page == "docs/README.html":
                    page = "index.html"
                text = FENCE.sub("", document.read_text(encoding="utf-8"))
                text = re.sub(r"(?s)!\[.*?\]\(\S+?\)|<!--.*?-->", "", text)
                lines = re.sub(r"(?m)^ *\d+\. ", "", text).split("\n")
                self.assertTrue(page in self.pages, "no link leads to it from docs/README.md")
                if page == "index.html":  # whose beginning is another
                    lines = lines[lines.index("## Make a picture"):]
                for line in lines:
                    if "](" not in line and "gallery" not in page:
                        self.has(flat(line), self.pages[page].text)

    def test_front_page(self):
        front = self.pages["index.html"]
        self.assertTrue(any("showcase" in link for link in front.loads))
        self.has(flat("./run render scenes/showcase.glb"), front.text)
        for command in commands():
            self.has(f"commands/{command}.html", front.links)

    def test_commands_have_all_flags_and_words(self):
        for command in commands():
            page = self.pages[f"commands/{command}.html"]
            whole, usual = printed(command, "--help-all"), printed(command, "--help")
            flags = re.compile(r"(?m)^  (?:-(\w), |    )--([a-z][\w-]*)")
            for short, long in flags.findall(whole):
                with self.subTest(command=command, flag=long):
                    self.has(f"cmdoption-wavepath-{command}-{long}", page.ids)
                    if short:
                        self.has(f"cmdoption-wavepath-{command}-{short}", page.ids)
            experts = len(flags.findall(whole)) - len(flags.findall(usual))
            self.assertEqual(page.classes.count("expert"), experts + bool(experts), "marks, and what they mean")
            for line in re.findall(r"(?m)^ {30}(.*)$", whole):  # but for those at whose ends something is inserted
                with self.subTest(command=command, line=line):
                    for words in re.split(r"docs/[\w-]+\.md", re.sub(r"\[?default: .*", "", line)):  # pages have titles
                        self.has(flat(words), page.text)
            self.assertNotIn("\u2013", " ".join(page.words), "-- of a flag became a dash")
            for heading in re.findall(r"(?m)^([A-Z][^\n:]*)\n  ", whole):
                self.has(flat(heading), page.text)

    def test_python_api_is_whole(self):
        """All public names, and the public methods and properties of classes of which it has the class."""
        ids = self.pages["api/python.html"].ids
        package = ROOT / "python" / "wavepath"
        init = ast.parse((package / "__init__.py").read_text())
        public = next(ast.literal_eval(node.value) for node in init.body
                      if isinstance(node, ast.Assign) and node.targets[0].id == "__all__")
        self.assertGreater(len(public), 20)
        for one in public:
            self.has(f"wavepath.{one}", ids)
        for file in [*package.glob("[!_]*.py"), package / "_core.pyi"]:
            for node in ast.parse(file.read_text()).body:
                if not isinstance(node, ast.ClassDef) or (file.suffix == ".pyi" and node.name == "Result"):
                    continue
                names = {f"wavepath.{node.name}", f"wavepath.{file.stem}.{node.name}"} & ids
                if not names:
                    continue
                for member in node.body:
                    if isinstance(member, ast.FunctionDef) and not member.name.startswith("_"):
                        with self.subTest(file=file.name, member=f"{node.name}.{member.name}"):
                            self.has(f"{min(names)}.{member.name}", ids)

    def test_cpp_api_is_whole(self):
        page = self.pages["api/cpp.html"]
        for header in sorted((ROOT / "include" / "wavepath").glob("*.h")):
            if header.name in ("wavepath.h", "export.h"):
                continue
            text = header.read_text()
            self.has(flat(f"<wavepath/{header.name}>"), page.text)
            open_text = re.sub(r"(?s)\nprivate:.*?\n\};", "", text)
            # Types that are declared alone are inside of the library, and so is what names them.
            for inner in re.findall(r"(?m)^struct (\w+);$", text):
                open_text = re.sub(rf"(?m)^.*\b{inner}\b.*$", "", open_text)
            code = re.sub(r"//[^\n]*", "", open_text)
            names = re.findall(r"\b(?:struct|class|enum class)(?: WAVEPATH_API)? (\w+)[^;{]*\{", code)
            names += re.findall(r"(?m)^ *(?:WAVEPATH_API |static )?[\w:<>,*& ]+[ &*](\w+)\(", code)
            members = re.sub(r"(?s)\([^()]*\)|\{[^{}]*:[^{}]*\}", "", code)
            names += re.findall(r"(\w+)(?:\{\}| = [\w.\-]+)?[,;]", members)
            for one in set(names) - {"override"}:
                with self.subTest(header=header.name, name=one):
                    self.has(flat(one), page.text)
            for comment in re.findall(r"(?m)^ *// (.*)$", open_text.split("namespace wavepath_v0 {", 1)[1]):
                with self.subTest(header=header.name, comment=comment):
                    self.has(flat(comment), page.text)

    def test_gallery_has_pictures_with_commands(self):
        page = self.pages["benchmarks/results/gallery/README.html"]
        rows = re.findall(r"(?m)^\| !\[\w+\]\((\S+)\) \| (.*?) \| `(.*?)` ", GALLERY.read_text(encoding="utf-8"))
        self.assertGreaterEqual(len(rows), 8)
        for file, what, command in rows:
            with self.subTest(file=file):
                stem, dot, suffix = file.partition(".")  # another picture may have the name
                self.assertTrue(any(re.search(rf"/{stem}\d*{re.escape(dot + suffix)}$", link) for link in page.loads))
                self.has(flat(what), page.text)
                self.has(flat(command), page.text)

    def test_words_of_the_glossary_are_linked(self):
        glossary = self.pages["docs/glossary.html"]
        terms = {anchor for anchor in glossary.ids if anchor.startswith("term-")}
        self.assertGreater(len(terms), 60)
        linked = {link.partition("#")[2] for page in self.pages.values() for link in page.links if "#term-" in link}
        self.assertGreater(len(linked & terms), 25)

    def test_flags_in_texts_are_linked(self):
        links = self.pages["docs/farm.html"].links
        for anchor in ("samples", "resume", "devices"):
            self.has(f"../commands/render.html#cmdoption-wavepath-render-{anchor}", links)
        self.has("../commands/study.html#cmdoption-wavepath-study-vary", self.pages["docs/study.html"].links)
        self.has("../api/python.html#wavepath.Interrupted", self.pages["docs/python.html"].links)

    def test_drawings_need_no_script(self):
        for document in DOCUMENTS:
            drawings = [block for language, block in fences(document) if language == "mermaid"]
            if drawings:
                page = self.pages[name(document.with_suffix(".html"))]
                self.assertEqual(page.classes.count("drawing"), len(drawings))
                for group in re.findall(r"subgraph (\w+)", "".join(drawings)):
                    self.assertNotIn(group, page.words, "a group is no node too")
                for label in re.findall(r'\["(.*?)"\]', "".join(drawings)):
                    self.has(flat(label.replace("<br/>", " ")), page.text)


def find_python():
    """A Python that has what the site needs, or what is missing."""
    if not shutil.which("dot"):
        return None, "Graphviz (dot)"
    for python in dict.fromkeys((sys.executable, "/usr/bin/python3")):
        modules = "import sphinx, myst_parser, furo"
        if shutil.which(python) and not subprocess.run([python, "-c", modules], capture_output=True).returncode:
            return python, ""
    return None, "Sphinx, MyST or furo (python3-sphinx, python3-myst-parser, furo)"


if __name__ == "__main__":
    Site.python, missing = find_python()
    suite = unittest.defaultTestLoader.loadTestsFromTestCase(Examples)
    if Site.python:
        suite.addTests(unittest.defaultTestLoader.loadTestsFromTestCase(Site))
    passed = unittest.TextTestRunner().run(suite).wasSuccessful()
    if not Site.python:
        print(f"SKIPPED: the site is not built, because {missing} is not installed; './run setup' installs it",
              file=sys.stderr)
    sys.exit(1 if not passed else 0 if Site.python else 77)
