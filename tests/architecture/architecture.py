#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that the sources keep to the architecture. Usage: architecture.py TOP; prints what breaks a rule, status 1."""
import ast
import re
import sys
from pathlib import Path

# Libraries whose types stay inside .cpp files; a header that must show one is named after it, an adapter, or a
# module's private *_impl.hpp.
HIDDEN = {"CGAL": "cgal", "OpenMesh": "openmesh", "fcl": "fcl", "ompl": "ompl", "yaml-cpp": "yaml",
          "nlohmann": "json", "tinyxml2": "xml", "tiny_gltf.h": "tinygltf"}
# What opens files; allowed in lib/base alone.
OPENS = re.compile(r"\bstd::(?:basic_)?[io]?fstream\b|\bfopen\s*\(|::open\s*\(|#include <fstream>")
# What the C library computes differently on other processors, also through Eigen and <random>: base/trig.hpp and
# base/rotation.hpp have it with the same bits everywhere.
LIBM = re.compile(
    r"(?<![\w.>])(?:std::|::|__builtin_)?(?:a?(?:sin|cos|tan)h?|atan2|sincos|hypot|pow|exp[2m]?1?|log(?:2|10|1p|b)?|cbrt|erfc?|[tl]gamma)"
    r"[fl]?\s*\(|using std::(?:sin|cos|tan|atan2|hypot|pow|exp|log)\b|\bEigen::(?:AngleAxis|Rotation2D|umeyama)|\bAngleAxis[df]?\b"
    r"|\.(?:slerp|angularDistance|eulerAngles|canonicalEulerAngles|sin|cos|tan|atan|exp|log|pow)\(|std::(?:complex|\w+_distribution)\b"
    r"|<(?:complex|random|tgmath\.h)>|unsupported/Eigen")
# Beside all of lib: what makes the inputs of golden texts.
SAME_BYTES = ("lib/**/*.?pp", "tests/golden/*.?pp", "tests/program/sample_plan.?pp")
# File -> why its result reaches no output. Libraries (FCL, OMPL, CGAL, OpenCASCADE) keep the C library's: decision 0041.
LIBM_ALLOWED = {}
COMMENT_OR_STRING = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', re.DOTALL)
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)
SOURCE_SUFFIXES = {".cpp", ".hpp", ".py", ".sh", ".cmake", ".js", ".mjs", ".css", ".m"}
SKIPPED_FOLDERS = {".git", "build", "node_modules", "vendor"}
# Modules of Python that Debian packages bring; tests of the slow tier alone skip what is not installed.
PYTHON_PACKAGES = {"gcode": "linuxcnc-uspace", "numpy": "python3-numpy", "yaml": "python3-yaml"}
SLOW_PYTHON = {"vtkmodules"}


# A type defined at namespace scope, not one of another's members.
TYPE = re.compile(r"^\s*(?:template\s*<[^{};]*>\s*)?(?:struct|class|union|enum(?:\s+class)?)\s+(?:alignas\(\w+\)\s*)?(\w+)(?:\s+final)?"
                  r"(?:\s*:(?!:)[^{};]*)?\s*$")


def types_of(text):
    """Qualified names of the types that other files can see, which a source file defines."""
    text = re.sub(r"'(?:\\.|[^'\\])'", "' '", COMMENT_OR_STRING.sub(" ", re.sub(r"^\s*#.*$", "", text, flags=re.MULTILINE)))
    scopes, begin = [], 0
    for at in re.finditer(r"[{};]", text):
        head, begin = text[begin:at.start()], at.end()
        if at.group() == "}":
            del scopes[-1:]
        elif at.group() == "{":
            space = re.search(r"\bnamespace\s*([\w:]*)\s*$", head)
            named = TYPE.match(head)
            if named and all(scopes):
                yield "::".join((*scopes, named.group(1)))
            scopes.append(space.group(1) if space else "")


def check_one_definition(top):
    """The linker keeps one of two types of one name, with its destructor, and says nothing."""
    found = {}
    for file in sorted(file for place in ("lib", "apps", "tests") for file in (top / place).rglob("*.?pp")):
        for name in types_of(file.read_text()):
            other = found.setdefault(name, file)
            if other != file:
                yield f"{file.relative_to(top)}: {name} is defined in {other.relative_to(top)} too"


# The rooms of lib/ in the order of the data: what stands in one may use its own room and those before it.
ROOMS = ("base", "geometry", "machine", "toolpath", "planning", "program", "report", "audit", "store", "job", "run")
# Headers that other programs include; no code.
PUBLIC = "millpose"


def modules(top):
    """The modules of lib/: name -> (folder below lib, the modules that its CMake file links (USES))."""
    found = {}
    for cmake in sorted((top / "lib").rglob("CMakeLists.txt")):
        text = re.sub(r"#.*", "", cmake.read_text())
        for name, body in re.findall(r"millpose_module\(\s*(\w+)(.*?)\)", text, re.DOTALL):
            words = re.search(r"\bUSES\b(.*?)(?=\bLINK\b|\bSOURCES\b|\bOWN_PCH\b|\Z)", body, re.DOTALL)
            found[name] = (cmake.parent.relative_to(top / "lib").as_posix(), words.group(1).split() if words else [])
    return found


def reachable(found, name, seen=()):
    """All modules that `name` may use; raises ValueError on a cycle."""
    if name in seen:
        raise ValueError("cycle of modules: " + " -> ".join((*seen, name)))
    reached = set()
    for other in found.get(name, ("", []))[1]:
        reached |= {other} | reachable(found, other, (*seen, name))
    return reached


def folder_of(path, folders):
    """The innermost folder of `folders` that holds `path` (below lib), or its first part."""
    inside = [folder for folder in folders if path.startswith(folder + "/")]
    return max(inside, key=len, default=path.split("/")[0])


def check_modules(top):
    found = modules(top)
    allowed_in, cycles = {}, []  # folder -> the folders that its modules may use
    for name, (folder, _) in found.items():
        try:
            allowed_in.setdefault(folder, set()).update(found[other][0] for other in reachable(found, name) | {name} if other in found)
        except ValueError as error:
            cycles.append(str(error))
    yield from cycles
    if cycles:
        return
    folders = {folder for folder, _ in found.values()}
    for folder, allowed in allowed_in.items():
        for file in sorted((top / "lib" / folder).rglob("*.?pp")):
            if folder_of(file.relative_to(top / "lib").as_posix(), folders) != folder:
                continue
            for quote, path in INCLUDE.findall(file.read_text()):
                if quote == '"' and folder_of(path, folders) not in allowed:
                    yield f"{file.relative_to(top)}: includes {path}, but {folder} does not use {folder_of(path, folders)}"


def check_rooms(top):
    """No module links one of a later room, and every folder of lib is a room."""
    found = modules(top)
    for file in sorted((top / "lib").iterdir()):
        if file.is_dir() and file.name not in (*ROOMS, PUBLIC):
            yield f"lib/{file.name} is no room: {', '.join(ROOMS)}"
    number = {name: ROOMS.index(folder.split("/")[0]) for name, (folder, _) in found.items() if folder.split("/")[0] in ROOMS}
    for name, (_, uses) in found.items():
        for other in uses:
            if number.get(other, -1) > number.get(name, len(ROOMS)):
                yield f"{name} uses {other} of a later room"


def check_judge(top):
    """The independent judge (lib/audit) says whether the planner is right: it may share nothing with it but base."""
    shared = reachable(modules(top), "judge") - {"base"}
    if shared:
        yield f"judge uses {', '.join(sorted(shared))}; allowed: base alone"


def check_headers(top):
    for file in sorted((top / "lib").rglob("*.hpp")):
        text = file.read_text()
        if "#pragma once" not in text:
            yield f"{file.relative_to(top)}: lacks #pragma once"
        for _, path in INCLUDE.findall(text):
            library = path.split("/")[0]
            if library in HIDDEN and not any(word in file.name for word in (HIDDEN[library], "adapter", "_impl")):
                yield f"{file.relative_to(top)}: shows {path}; {library} stays inside .cpp files"


def check_files(top):
    for file in sorted((top / "lib").rglob("*.?pp")):
        if file.parent != top / "lib" / "base" and OPENS.search(file.read_text()):
            yield f"{file.relative_to(top)}: opens files; only lib/base does"


def check_same_bytes(top):
    for pattern in SAME_BYTES:
        for file in sorted(top.glob(pattern)):
            if str(file.relative_to(top)) in LIBM_ALLOWED:
                continue
            code = COMMENT_OR_STRING.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), file.read_text())
            for found in LIBM.finditer(code):
                line = code.count("\n", 0, found.start()) + 1
                yield f"{file.relative_to(top)}:{line}: {found[0].strip()} differs between processors; use base/trig.hpp"


def check_licence(top):
    for file in sorted(top.rglob("*")):
        folders = file.relative_to(top).parts[:-1]
        named = file.suffix in SOURCE_SUFFIXES or file.name == "CMakeLists.txt"
        if not named or not file.is_file() or SKIPPED_FOLDERS & set(folders):
            continue
        head = file.read_text().split("\n", 2)[:2]
        if "SPDX-License-Identifier: GPL-3.0-or-later" not in (head[1] if head[0].startswith("#!") else head[0]):
            yield f"{file.relative_to(top)}: the first line is not the SPDX line"


def check_python(top):
    """A machine of a developer has more modules than one with packages.txt alone."""
    files = [file for file in sorted(top.rglob("*.py")) if not SKIPPED_FOLDERS & set(file.relative_to(top).parts)]
    listed = (top / "packages.txt").read_text().split("\n") if (top / "packages.txt").exists() else []
    known = sys.stdlib_module_names | SLOW_PYTHON | {file.stem for file in files} | {file.parent.name for file in files}
    for file in files:
        for node in ast.walk(ast.parse(file.read_text())):
            names = ([alias.name for alias in node.names] if isinstance(node, ast.Import)
                     else [node.module] if isinstance(node, ast.ImportFrom) and not node.level else [])
            for name in {name.split(".")[0] for name in names} - known:
                if PYTHON_PACKAGES.get(name) not in listed:
                    yield f"{file.relative_to(top)}:{node.lineno}: no package of packages.txt brings {name}"


CHECKS = [check_modules, check_rooms, check_one_definition, check_judge, check_headers, check_files, check_same_bytes, check_licence,
          check_python]


def problems(top):
    return [problem for check in CHECKS for problem in check(Path(top))]


if __name__ == "__main__":
    found = problems(sys.argv[1])
    print("\n".join(found) or "architecture kept")
    sys.exit(1 if found else 0)
