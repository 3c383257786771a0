#!/usr/bin/env python3
"""The rules of CONTRIBUTING.md that a compiler does not check: includes go downhill, Vulkan has few doors, documents
tell the truth. Usage: structure_test.py SOURCE_DIR WAVEPATH_BINARY COMPILER"""

import concurrent.futures
import functools
import graphlib
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv[1])
WAVEPATH, COMPILER = sys.argv[2], sys.argv[3]

# A file includes only files of its own folder and of those before it.
DOWNHILL = [
    "bvh", "ktx", "kernels/base", "kernels/bvh", "kernels/surface", "kernels/light", "kernels/volume", "kernels/film",
    "kernels/display",
    "kernels/path", "kernels/bidirectional", "kernels/hybrid/shading", "kernels/hybrid/voxels",
    "kernels/hybrid/shadows", "kernels/hybrid",
    "kernels/hybrid/reflections", "kernels/hybrid/transparency", "kernels/hybrid/occlusion",
    "kernels/hybrid/bounce",
    "kernels/hybrid/antialias", "kernels/whitted", "kernels/radiosity",
    "kernels/selftest", "kernels/bench",
    "host/base", "host/codecs", "host/codecs/openimageio", "host/scene", "host/scene/nanovdb", "host/scene/staging",
    "host/scene/gltf", "host/scene/pack", "host/gpu", "host/picture", "host/film", "host/picture/files",
    "host/picture/filter", "host/picture/metrics",
    "host/render/settings", "host/render/workspace", "host/render/loop", "host/render", "host/render/multi_device",
    "host/render/progressive", "host/plan", "host/render/report",
    "host/integrators/path", "host/integrators/bidirectional", "host/integrators/hybrid/raster",
    "host/integrators/hybrid/voxels",
    "host/integrators/hybrid/shading", "host/integrators/hybrid/shadows", "host/integrators/hybrid/reflections",
    "host/integrators/hybrid/bounce",
    "host/integrators/hybrid/transparency", "host/integrators/hybrid/occlusion", "host/integrators/hybrid/antialias",
    "host/integrators/hybrid",
    "host/integrators/whitted", "host/integrators/radiosity", "host/integrators", "host/passes", "host/session",
    "host/session/viewing",
    "benchmarks",
    "host/bench/structures", "host/bench", "host/selftest", "host/study", "host/view", "host/serve", "host/convert",
    "host/cli",
    "host/library", "host",
]
VULKAN_DOORS = {"host/gpu", "host/view"}
DOCUMENTS = ["README.md", "CONTRIBUTING.md", "scenes/README.md",
             *(f"docs/{p.name}" for p in sorted(ROOT.glob("docs/*.md")))]


def sources(*suffixes):
    for folder in ("bvh", "ktx", "kernels", "host", "tests", "benchmarks"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in suffixes:
                yield path


def name(path):
    return str(path.relative_to(ROOT))


def folder(path):
    return name(path.parent)


def includes(path):
    return re.findall(r'^\s*#include "([^"]+)"', path.read_text(), re.M)


def text_files():
    """What people read: sources and documents, but nothing that a build or a user has put beside them."""
    kinds = (".h", ".cpp", ".glsl", ".comp", ".vert", ".frag", ".py", ".md", ".txt", "")
    for folder in ("bvh", "ktx", "kernels", "host", "include", "python", "examples", "scenes", "tests", "benchmarks",
                   "docs", "farm", "packaging", "blender", ".ci"):
        yield from (p for p in sorted((ROOT / folder).rglob("*")) if p.is_file() and p.suffix in kinds)
    yield from (ROOT / n for n in ("run", "CMakeLists.txt", "CMakePresets.json", "README.md", "CONTRIBUTING.md",
                                   "CHANGELOG.md"))


# Headers that the build or test_headers_compile_alone precompiles, so that no compiler misses them, and what tells that
# a file uses one.
ALGORITHMS = ("all_of|any_of|clamp|copy|count|count_if|equal|fill|find|find_if|max|max_element|min|min_element|none_of|"
              "sort|transform")
PRECOMPILED = {
    "algorithm": rf"\bstd::(ranges::)?({ALGORITHMS}|minmax|nth_element|stable_sort)\(",
    "array": r"\bstd::array<",
    "chrono": r"\bstd::chrono::",
    "cmath": r"\bstd::(atan2|ceil|cos|exp|floor|fmod|hypot|isfinite|isnan|log|log2|lround|pow|round|sin|sqrt|tan)\(",
    "filesystem": r"\bstd::filesystem\b",
    "fstream": r"\bstd::[io]?fstream\b",
    "functional": r"\bstd::(function|hash)<",
    "future": r"\bstd::(future<|async\()",
    "deque": r"\bstd::deque<",
    "list": r"\bstd::list<",
    "map": r"\bstd::(multi)?map<",
    "memory": r"\bstd::((unique|shared)_ptr|make_(unique|shared))<",
    "numeric": r"\bstd::(accumulate|gcd|inner_product|iota|partial_sum|reduce)\(",
    "optional": r"\bstd::(optional<|nullopt\b)",
    "random": r"\bstd::mt19937",
    "span": r"\bstd::span\b",
    "string": r"\bstd::(string\b|to_string\()",
    "vector": r"\bstd::vector<",
    "fmt/": r"\bfmt::(format|join|print)\(",
    "glm/": r"\bglm::",
    "nlohmann/json": r"\bnlohmann::",
    "vulkan/vulkan.h": r"\bVk[A-Z]\w+|\bvk[A-Z]\w+\(",
    "tbb/parallel_for.h": r"\btbb::parallel_for\(",
    "gtest/gtest.h": r"\b(TEST|TEST_F|TEST_P)\(",
}


@functools.cache
def reached_headers(path):
    """System headers that a file includes, itself or by way of the project's own."""
    reached = set(re.findall(r"^\s*#include <([^>]+)>", path.read_text(), re.M))
    for include in includes(path):
        if (ROOT / include).exists():
            reached |= reached_headers(ROOT / include)
    return reached


@functools.cache
def reached_files(path):
    """The project's own files that a file includes, itself or by way of others; generated ones as well."""
    reached = set(includes(path))
    for include in includes(path):
        if (ROOT / include).exists():
            reached |= reached_files(ROOT / include)
    return reached


@functools.cache
def code_of(path):
    return re.sub(r'R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|//[^\n]*', "", path.read_text(), flags=re.S)


TYPE_WORDS = "struct|class|enum class|enum|using|typename"


def constants_of(code, start):
    """Of enumerations, and of declarations, those whose values are braced included."""
    names = set()
    for members in re.findall(start + r"enum\b[^{;]*\{([^}]*)\}", code, re.M):
        names.update(re.findall(r"\bk[A-Z]\w*(?=\s*(?:[=,]|$))", members))
    for statement in re.findall(start + r"(?:inline|GPU_CONSTANT|constexpr|const|extern)\b[^;]*;", code, re.M):
        names.update(re.findall(r"(?<!&)\bk[A-Z]\w*(?=\s*[=\[{]|[;,][^={}]*$)", statement))
    return names


@functools.cache
def declared_names(path):
    """Types, constants and functions that a header declares for all."""
    code = code_of(path)
    types = re.findall(rf"^(?:template <.*>\s+)?(?:{TYPE_WORDS}) (?:WAVEPATH_API )?(\w+)(?=[^;]*?[{{=])", code, re.M)
    functions = re.findall(rf"^(?!return|#|{TYPE_WORDS})[\w\[][\w:<>,*& \[\]]* [*&]?(\w+)\(", code, re.M)
    return {*types, *functions} | constants_of(code, "^")


@functools.cache
def inner_names(path):
    """Types and functions within others, what is declared without being defined, and template parameters."""
    code = code_of(path)
    types = re.findall(rf"\b(?:{TYPE_WORDS}) (\w+)", code)
    functions = re.findall(r"^ +(?!return\b|throw\b)[\w\[][\w:<>,*& \[\]]* [*&]?(\w+)\([^;]*\)[ \w]*[;{]$", code, re.M)
    return {*types, *functions}


def local_names(path):
    """Functions and constants of a file itself, and of the insides of its classes and functions."""
    code = code_of(path)
    variables = re.findall(r"\b(?!return\b|else\b|throw\b|case\b)\w+[>*&\]]* [*&]?([a-z]\w*)(?=\s*[={(\[,;:)])", code)
    return {*variables} | constants_of(code, r"\b")


@functools.cache
def offered_names(path):
    """All names that a file, with what it includes of ours, makes known to what is compiled after it."""
    files = [ROOT / r for r in {name(path), *reached_files(path)} if (ROOT / r).exists()]
    macros = (set(re.findall(r"^\s*#define (\w+)", file.read_text(), re.M)) for file in files)
    return set().union(*map(declared_names, files), *map(inner_names, files), *map(local_names, files), *macros)


def batches(headers, system_files):
    """Headers in lists, of which each is compiled as one file. A compiler takes a third of a second to begin, and few
    headers can hide what another lacks: those that make a word of it known, or include a foreign header, which it does
    not reach itself."""
    found = []
    for header in sorted(headers, key=lambda path: len(reached_files(path))):
        words = set(re.findall(r"\w+", code_of(header)))
        for batch, offered, foreign in found:
            hidden = words & (offered - offered_names(header))
            if not hidden and foreign <= reached_headers(header):
                break
        else:
            found.append(([], set(), set()))
            batch, offered, foreign = found[-1]
        batch.append(header)
        offered |= offered_names(header)
        foreign |= {h for h in reached_headers(header) if not any(file.endswith(f"/{h}") for file in system_files)}
    return [batch for batch, _, _ in found]


class Structure(unittest.TestCase):
    def test_words_cost_no_picture(self):
        """fmt::print throws where a stream cannot be written: host/base/print.h knows what that is to mean."""
        for path in sources(".h", ".cpp"):
            if name(path).startswith("host/"):
                with self.subTest(file=name(path)):
                    self.assertNotRegex(code_of(path), r"\bfmt::print\(|\bstd::c(out|err)\b")

    def test_files_include_what_is_precompiled(self):
        for path in sources(".h", ".cpp"):
            code = re.sub(r"//.*", "", path.read_text())
            for header, use in PRECOMPILED.items():
                with self.subTest(file=name(path), header=header):
                    if re.search(use, code):
                        self.assertTrue(any(h.startswith(header) for h in reached_headers(path)))

    def test_files_include_what_they_use_of_ours(self):
        """Files of a folder are compiled together (WAVEPATH_UNITY), so that no compiler misses what another one has
        included. The preset `debug` compiles each by itself: it sees what this does not, as functions named by one
        word."""
        homes = {}
        for header in sources(".h"):
            for declared in declared_names(header):
                homes.setdefault(declared, set()).add(name(header))
        self.assertGreater(len(homes), 1500)
        for path in sources(".h", ".cpp"):
            if path.is_relative_to(ROOT / "tests"):
                continue
            reached = reached_files(path)
            files = [ROOT / r for r in {name(path), *reached} if (ROOT / r).exists()]
            known = local_names(path).union(*map(inner_names, files))
            if folder(path) == "host/library":  # where a name of the interface may be that of something inside
                known |= set().union(*(declared_names(h) for h in (ROOT / "include/wavepath").glob("*.h")))
            used = re.findall(r"(?<![\w.>:])(?:(?:gpu|bvh|spirv)::)?([A-Z]\w*|k[A-Z]\w*|[a-z]\w*_\w*(?=\())\b",
                              code_of(path))
            for use in set(used) - known - declared_names(path):
                with self.subTest(file=name(path), name=use):
                    self.assertTrue(use not in homes or homes[use] & reached)
            for kernel in re.findall(r"\bwavepath_(\w+)_spv\b", code_of(path)):
                with self.subTest(file=name(path), kernel=kernel):
                    self.assertTrue(any(r.endswith(f"/{kernel}.spv.h") for r in reached))

    def test_includes_go_downhill(self):
        for path in sources(".h", ".cpp", ".glsl", ".comp", ".vert", ".frag"):
            if folder(path) not in DOWNHILL:
                continue
            for include in includes(path):
                target = str(pathlib.PurePosixPath(include).parent)
                with self.subTest(file=name(path), include=include):
                    if include.endswith(".spv.h"):
                        continue  # generated from kernels/
                    self.assertIn(target, DOWNHILL)
                    self.assertTrue((ROOT / include).exists())
                    self.assertLessEqual(DOWNHILL.index(target), DOWNHILL.index(folder(path)))

    def test_includes_form_no_cycle(self):
        """Nor inside a folder: all files can be put in an order in which each includes only those before it. x.h and
        x.cpp count as one."""
        included = {}
        for path in sources(".h", ".cpp", ".glsl", ".comp", ".vert", ".frag"):
            if not path.is_relative_to(ROOT / "tests"):
                included.setdefault(name(path.with_suffix("")), set()).update(
                    str(pathlib.PurePosixPath(i).with_suffix("")) for i in includes(path))
        order = graphlib.TopologicalSorter({f: others - {f} for f, others in included.items()})
        self.assertGreater(len(tuple(order.static_order())), 200)  # raises CycleError, which names the files

    def test_vulkan_has_few_doors(self):
        for path in sources(".h", ".cpp"):
            if folder(path) not in VULKAN_DOORS:
                with self.subTest(file=name(path)):
                    self.assertNotRegex(path.read_text(), r"\bVk[A-Z]\w+|\bvk[A-Z]\w+\(|\bVK_[A-Z]+_")

    def test_long_cases_exist(self):
        """One that is misspelled would run among the short ones, unseen."""
        lists = re.findall(r"set\(long_(\w+)\s+([^)]*)\)", (ROOT / "tests/CMakeLists.txt").read_text())
        subjects = dict((subject, cases.split()) for subject, cases in lists if subject not in ("subjects", "tests"))
        self.assertEqual(set(subjects), {*dict(lists)["subjects"].split(), "window"})
        for subject, cases in subjects.items():
            known = re.findall(r"^TEST(?:_F|_P)?\(\w+, (\w+)\)", (ROOT / f"tests/{subject}_test.cpp").read_text(), re.M)
            with self.subTest(subject=subject):
                self.assertEqual({case.strip('"').split("/")[0] for case in cases} - set(known), set())

    def test_every_file_begins_with_its_job(self):
        """x.cpp may leave that to x.h."""
        for path in sources(".h", ".cpp", ".glsl", ".comp", ".vert", ".frag"):
            twin = f'#include "{name(path.with_suffix(".h"))}"'
            with self.subTest(file=name(path)):
                self.assertTrue(path.read_text().startswith(("// ", twin)))

    def test_headers_compile_alone(self):
        """x.cpp includes x.h first, so compiling it by itself is the proof, for which
        test_files_include_what_they_use_of_ours stands in where files are compiled together; only headers without such
        a file are compiled here."""
        alone = []
        for path in sources(".h"):
            twin = path.with_suffix(".cpp")
            if not twin.exists():
                alone.append(path)
                continue
            with self.subTest(file=name(twin)):
                first = re.search(r'^#include [<"]([^">]+)[">]', twin.read_text(), re.M)
                self.assertEqual(first.group(1), name(path))
        generated = pathlib.Path(WAVEPATH).parent.parent / "generated"
        flags = [COMPILER, "-std=c++20", "-Wall", "-Wextra", f"-I{ROOT}", f"-I{ROOT}/include", f"-isystem{generated}",
                 "-DWAVEPATH_LIBRARY_SOURCES",
                 f'-DWAVEPATH_SOURCE_DIR="{ROOT}"', f'-DWAVEPATH_BINARY="{WAVEPATH}"']
        with tempfile.TemporaryDirectory() as folder:
            # Compiled once. That headers include these themselves is test_files_include_what_is_precompiled's.
            system = pathlib.Path(folder) / "system.h"
            whole = {"fmt/": "fmt/format.h", "glm/": "glm/glm.hpp", "nlohmann/json": "nlohmann/json.hpp"}
            system.write_text("".join(f"#include <{whole.get(header, header)}>\n" for header in PRECOMPILED))
            subprocess.run([*flags, "-x", "c++-header", system, "-o", f"{system}.gch"], check=True)
            known = subprocess.run([*flags, "-M", system], check=True, capture_output=True, text=True).stdout.split()

            def compile_in_turn(paths):
                turns = [word for path in paths for word in ("-include", name(path))]
                command = [*flags, "-fsyntax-only", "-include", system, *turns, "-x", "c++", os.devnull]
                return paths, subprocess.run(command, cwd=ROOT, capture_output=True, text=True)

            with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
                for paths, result in pool.map(compile_in_turn, batches(alone, {f"/{file}" for file in known})):
                    with self.subTest(files=[name(path) for path in paths]):
                        self.assertEqual(result.returncode, 0, result.stderr[:2000])

    def test_lines_fit(self):
        """clang-format keeps the width of C++ but for rules and raw strings, and nobody that of GLSL and Python."""
        for path in text_files():
            if path.suffix not in (".h", ".cpp", ".glsl", ".comp", ".vert", ".frag", ".py"):
                continue
            for number, line in enumerate(path.read_text().split("\n"), 1):
                if len(line) > 120:
                    with self.subTest(file=name(path), line=number):
                        self.assertLessEqual(len(line), 120)

    def test_documents_are_easy_to_read(self):
        """Prose keeps the width of code, no sentence hangs on a noun elsewhere, and few are long."""
        def prose(text):
            text = re.sub(r"```.*?```", "", text, flags=re.S)
            return [line for line in text.split("\n") if not line.lstrip().startswith(("|", "!["))]

        fragment = re.compile(r"(?:^|(?<=[.:] )|(?<=\*\* ))(?:Of|What|Whether|Which|Who)\b[^.?]*\.")
        for document in [*DOCUMENTS, "CHANGELOG.md", "benchmarks/results/NOTES.md"]:
            lines = prose((ROOT / document).read_text())
            with self.subTest(document=document):
                self.assertEqual([line for line in lines if len(line) > 120], [])
                if document.endswith("NOTES.md"):  # a log in the words of its days
                    continue
                for paragraph in re.split(r"\n\s*\n|\n(?=\s*(?:[-*]|\d+\.) )", "\n".join(lines)):
                    text = " ".join(re.sub(r"^\s*(?:[-*]|\d+\.) ", "", paragraph).split())
                    self.assertIsNone(fragment.search(text), text)
                    longest = max(re.split(r"(?<=[.?!;:]) ", text), key=lambda sentence: len(sentence.split()))
                    self.assertLessEqual(len(longest.split()), 40, longest)
        self.assertLessEqual((ROOT / "CHANGELOG.md").read_text().count("\n"), 40, "0.1.0 is no history")

    def test_nothing_names_a_machine(self):
        for path in text_files():
            with self.subTest(file=name(path)):
                self.assertNotRegex(path.read_text(errors="replace"), r"(?<![\w.])/(home|root|work|Users)/\w")

    def test_nothing_is_left_unfinished(self):
        for path in text_files():
            if path != pathlib.Path(__file__).resolve():
                with self.subTest(file=name(path)):
                    self.assertNotRegex(path.read_text(errors="replace"), r"\b(TODO|FIXME|XXX)\b|#if 0\b")

    def test_commands_in_documents_exist(self):
        def helps(*command):
            result = subprocess.run([WAVEPATH, *command], capture_output=True, text=True)
            self.assertEqual(result.returncode, 0, command)
            return result.stdout

        known = helps("--help")
        checked = 0
        for document in DOCUMENTS:
            # At the start of a line, or quoted in a sentence or a table.
            pattern = r"(?:^(?:\$ )?|`)(?:\./run|wavepath) +([^#\n`]*)"
            for line in re.findall(pattern, (ROOT / document).read_text(), re.M):
                words = line.split()
                while words[0] in ("--no-install",):
                    words.pop(0)
                if words[0] in ("--help", "--version", "ARGS..."):
                    continue
                with self.subTest(document=document, line=line):
                    checked += 1
                    if words[0] in ("python", "test", "setup", "format", "site"):
                        continue
                    self.assertRegex(known, rf"(?m)^\s+{words[0]}\b")
                    options = helps(words[0], "--help-all")
                    for flag in words[1:]:
                        if flag.startswith("-"):
                            self.assertRegex(options, rf"(?<![\w-]){re.escape(flag)}(?![\w-])")
                        elif flag.startswith("scenes/"):
                            self.assertTrue((ROOT / flag).exists(), flag)
        self.assertGreater(checked, 1)

    def test_pages_open_alike(self):
        """What it does, when to use it, an example, and a table or a picture, before anything else."""
        for page in sorted(ROOT.glob("docs/*.md")):
            if page.name == "README.md":
                continue
            with self.subTest(page=page.name):
                opening = page.read_text().split("\n## ")[0]
                self.assertRegex(opening, r"\A# .+\n\n\*\*What it does\.\*\* ")
                self.assertRegex(opening, r"(?m)^\*\*When to (use it|care)\.\*\* ")
                self.assertRegex(opening, r"(?m)^(```|\*\*Example\.\*\* )")
                self.assertRegex(opening, r"(?m)^(\| ---|!\[|```mermaid)")

    def test_links_in_documents_lead_somewhere(self):
        def anchors(page):
            """Of headings, as GitHub names them."""
            titles = re.findall(r"^#+ +(.*)$", page.read_text(), re.M)
            return {re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-") for title in titles}

        results = [name(page) for page in sorted(ROOT.glob("benchmarks/results/**/*.md"))]
        for document in [*DOCUMENTS, "CHANGELOG.md", *results]:
            for target, anchor in re.findall(r"\]\(([^)#:\s]*)(?:#([^)\s]+))?\)", (ROOT / document).read_text()):
                with self.subTest(document=document, target=target, anchor=anchor):
                    page = (ROOT / document).parent / target if target else ROOT / document
                    self.assertTrue(page.exists())
                    if anchor:
                        self.assertIn(anchor, anchors(page))

    # Everyone who clones carries them; a page that a command makes again, which benchmarks/results/README.md tells,
    # stays out.
    def test_results_that_are_kept_weigh_little(self):
        files = [p for p in (ROOT / "benchmarks/results").rglob("*") if p.is_file()]
        self.assertLess(sum(p.stat().st_size for p in files), 8e6)
        self.assertEqual([name(p) for p in files if p.suffix == ".html"], [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
