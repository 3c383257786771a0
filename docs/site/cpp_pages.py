"""The page of the C++ library, made of the headers in include/wavepath and of their comments."""

import dataclasses
import re

FIRST = ("session", "scene", "camera", "settings", "result", "device", "compare", "command", "error")
FOLDER = "include/wavepath"


@dataclasses.dataclass
class Declaration:
    about: str  # the comment before it, or behind it
    code: str  # without comments, bodies and WAVEPATH_API
    members: list = dataclasses.field(default_factory=list)

    def kind(self):
        match = re.match(r"(?:template <.*> )?(enum class|struct|class|using)\b", self.code)
        if match:
            return match[1]
        code, count = self.code, 1
        while count:  # arguments of templates, from the inside
            code, count = re.subn(r"<[^<>]*>", "", code)
        return "function" if re.match(r"[^={]*\w\(", code) else "member"


def split_comment(line):
    """Code and comment of a line, none of which has // in a string."""
    code, _, comment = line.partition("//")
    return code.rstrip(), comment.strip()


def depth_of(code):
    return sum(code.count(c) for c in "({[") - sum(code.count(c) for c in ")}]")


class Reader:
    """Reads declarations of a header, one level of braces after the other."""

    def __init__(self, lines):
        self.lines, self.at = lines, 0

    def read(self, is_class=False):
        found, comment, hidden = [], [], False
        while self.at < len(self.lines):
            line = self.lines[self.at].strip()
            code, behind = split_comment(line)
            if code in ("}", "};"):
                self.at += 1
                break
            if not code:
                comment = [*comment, behind] if line.startswith("//") else []
                self.at += 1
                continue
            if code in ("public:", "private:"):
                hidden, comment = code == "private:", []
                self.at += 1
                continue
            declaration = self.one(comment)
            comment = []
            if declaration and not (hidden and is_class):
                found.append(declaration)
        return found

    def one(self, comment):
        code, comments = "", list(comment)
        opened = re.match(r"(struct|class) ", self.lines[self.at].strip())
        while True:
            text, behind = split_comment(self.lines[self.at].strip())
            code = f"{code} {text}".strip()
            comments += [behind] if behind else []
            self.at += 1
            if opened and code.endswith("{"):
                code = code[:-1].strip()
                return Declaration(joined(comments), tidy(code), Reader.read(self, is_class=True))
            if depth_of(code) == 0 and (code.endswith(";") or code.endswith("}")):
                break
        return Declaration(joined(comments), tidy(code))


def joined(comment):
    paragraphs = "\n".join(comment).split("\n\n")
    return "\n\n".join(" ".join(paragraph.split()) for paragraph in paragraphs)


def tidy(code):
    """A declaration without what its reader does not need: bodies, lists of initializers, marks for the linker."""
    code = code.replace("WAVEPATH_API ", "")
    if not re.match(r"enum class|struct|class|using", code):
        code = re.sub(r"\)((?: const)?) (?:: \w+[({].*|\{.*\})$", r")\1", code)
        code = re.sub(r"(?<! )\{\}(?=;|,)", "", code)
    return code.rstrip(";").replace(" override", "").strip()


def is_inside(declaration, inner):
    """Not for programs: destructors, and what names a type that only the library can make."""
    code = declaration.code
    return (code.startswith("~") or re.match(r"using \w+::\w+$", code) or code in inner or
            any(re.search(rf"\b{name.split()[1]}\b", code) for name in inner))


def documentation(about):
    """The comment as reStructuredText: `code` is ``code``, the rest is plain."""
    parts = re.split(r"(`[^`]+`)", about)
    return "".join(f"`{part}`" if part.startswith("`") else re.sub(r"([\\*|_])", r"\\\1", part) for part in parts)


def sentence(text):
    """Comments behind members are no whole sentences."""
    return text[0].upper() + text[1:] + ("" if text[-1] in ".:" else ".")


def declarators(code):
    """`int a = 0, b = 0` as two declarations, whose type is the same."""
    pieces, depth, start = [], 0, 0
    for i, c in enumerate(code):
        depth += (c in "({[<") - (c in ")}]>")
        if c == "," and depth == 0:
            pieces.append(code[start:i].strip())
            start = i + 1
    pieces.append(code[start:].strip())
    kind = re.match(r"(.*?[\s&*>])\w+(?: = .*)?$", pieces[0])
    return [pieces[0], *(f"{kind[1].strip()} {piece}" for piece in pieces[1:])]


def lines_of(declarations, inner, level=0):
    lines, indent = [], "   " * level
    for declaration in declarations:
        if is_inside(declaration, inner):
            continue
        kind, code = declaration.kind(), declaration.code
        body = [declaration.about] if declaration.about else []
        enumerators = []
        if kind == "enum class":
            code, _, values = code.partition("{")
            enumerators = [value.strip() for value in values.rstrip("} ").split(",")]
            directive, codes = "enum-class", [code.removeprefix("enum class ").strip()]
        elif kind in ("struct", "class"):
            directive, codes = kind, [code.removeprefix(f"{kind} ")]
        elif kind == "using":
            directive, codes = "type", [code.removeprefix("using ")]
        elif kind == "function":
            directive, codes = "function", [code]
        else:
            directive, codes = "member", declarators(code)
        lines += [f"{indent}.. cpp:{directive}:: {codes[0]}",
                  *(f"{indent}{' ' * (len(directive) + 12)}{code}" for code in codes[1:]), ""]
        for paragraph in "\n\n".join(body).split("\n\n"):
            if paragraph:
                lines += [f"{indent}   {sentence(documentation(paragraph))}", ""]
        for value in enumerators:
            lines += [f"{indent}   .. cpp:enumerator:: {value}", ""]
        lines += lines_of(declaration.members, inner, level + 1)
    return lines


def read(text):
    """The job of a header, and its declarations."""
    job = text.split("\n")[0].removeprefix("// ")
    inside = text.split("namespace wavepath_v0 {\n", 1)[1]
    return job, Reader(inside.split("\n")).read()


def write(stage):
    lines = ["C++ API", "=======", "",
             "``#include <wavepath/wavepath.h>`` includes all headers. :doc:`/docs/library` tells how programs are "
             "built, and what they can rely on. Functions throw :cpp:class:`wavepath::Error`.", "",
             ".. cpp:namespace:: wavepath", "", ".. default-role:: code", ""]
    others = sorted(file.stem for file in (stage.root / FOLDER).glob("*.h") if file.stem not in ("wavepath", "export"))
    for header in dict.fromkeys([*FIRST, *others]):
        job, declarations = read(stage.text(f"{FOLDER}/{header}.h"))
        inner = [one.code for one in declarations if one.kind() == "struct" and not one.members and not one.about]
        title = f"<wavepath/{header}.h>"
        lines += [title, "-" * len(title), "", documentation(job), "", *lines_of(declarations, inner)]
    stage.write("api/cpp.rst", "\n".join(lines))
