# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the YAML that millpose writes (job.yaml and cell.yaml of an output folder), and walks it with its schema."""
import json
import re

NUMBER = re.compile(r"-?\d+(\.\d+)?(e[-+]?\d+)?$")


def scalar(text):
    if text.startswith('"'):
        return json.loads(text)
    if text in ("true", "false"):
        return text == "true"
    if NUMBER.match(text):
        return float(text) if re.search(r"[.e]", text) else int(text)
    return text


class Flow:
    """{a: 1, b: [x, "y"]} from its place in a text."""

    def __init__(self, text):
        self.text, self.at = text, 0

    def skip(self):
        while self.at < len(self.text) and self.text[self.at] in " ,":
            self.at += 1

    def value(self, ends=",]}"):
        self.skip()
        first = self.text[self.at]
        if first == "{":
            return self.items("}", {}, lambda found: found.__setitem__(self.key(), self.value()))
        if first == "[":
            return self.items("]", [], lambda found: found.append(self.value()))
        if first == '"':
            found, length = json.JSONDecoder().raw_decode(self.text[self.at:])
            self.at += length
            return found
        start = self.at
        while self.at < len(self.text) and self.text[self.at] not in ends:
            self.at += 1
        return scalar(self.text[start:self.at].strip())

    def items(self, end, found, add):
        self.at += 1
        self.skip()
        while self.text[self.at] != end:
            add(found)
            self.skip()
        self.at += 1
        return found

    def key(self):
        key = self.value(ends=":")
        self.at += 1
        return str(key)


def parse(text):
    lines = [(len(line) - len(line.lstrip()), line.strip()) for line in text.splitlines() if line.strip()]

    def inline(word):
        return Flow(word).value() if word[0] in "{[" else scalar(word)

    def block(at):
        indent, is_list = lines[at][0], lines[at][1].startswith("-") and not NUMBER.match(lines[at][1])
        found = [] if is_list else {}
        while at < len(lines) and lines[at][0] == indent:
            word = lines[at][1]
            if is_list:
                key, rest = None, word[1:].strip()
            else:
                key, _, rest = word.partition(":")
                rest = rest.strip()
            at += 1
            if rest:
                item = inline(rest)
            else:
                item, at = block(at)
            if is_list:
                found.append(item)
            else:
                found[key.strip('"')] = item
        return found, at

    return block(0)[0]


def as_map(schema):
    """Of a schema with alternatives the one that is a map with known keys."""
    return next((option for option in schema.get("anyOf", []) if "properties" in option), schema)


def leaves(schema, path=""):
    """Paths of all keys that hold values, as in "bodies[].shape.box.size_mm"; of one that may hold a value or keys, both."""
    found = [path] if as_map(schema) is not schema else []
    schema = as_map(schema)
    for key, inner in schema.get("properties", {}).items():
        found += leaves(inner, f"{path}.{key}" if path else key)
    if isinstance(schema.get("additionalProperties"), dict):
        found += leaves(schema["additionalProperties"], path + ".*")
    if schema.get("type") == "array" and "properties" in schema.get("items", {}):
        found += leaves(schema["items"], path + "[]")
    return found or [path]


def places(schema, value, path=""):
    """(path as in leaves(), container, key, schema) of every value that stands in `value`."""
    schema = as_map(schema)
    known = schema.get("properties", {})
    for key, inner in value.items():
        rest = schema.get("additionalProperties")
        below = known.get(key) or (rest if isinstance(rest, dict) else {})
        name = (f"{path}.{key}" if path else key) if key in known else path + ".*"
        if isinstance(inner, dict):
            yield from places(below, inner, name)
        elif isinstance(inner, list) and "properties" in below.get("items", {}):
            for item in inner:
                yield from places(below["items"], item, name + "[]")
        else:
            yield name, value, key, below
