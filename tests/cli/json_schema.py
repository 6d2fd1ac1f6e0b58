# SPDX-License-Identifier: GPL-3.0-or-later
"""A small judge of JSON values: the keywords of JSON Schema that docs/schema uses, and no others."""

TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}
KNOWN = {"$schema", "title", "description", "default", "type", "enum", "const", "properties", "required",
         "additionalProperties", "items", "minItems", "maxItems", "minLength", "minProperties", "maxProperties",
         "minimum", "maximum", "exclusiveMinimum", "oneOf"}


def is_type(value, name):
    if name in ("number", "integer"):
        return (isinstance(value, (int, float)) and not isinstance(value, bool)
                and (name == "number" or float(value).is_integer()))
    return isinstance(value, TYPES[name])


def problems(value, schema, path="$"):
    """What of `value` breaks `schema`, one sentence each."""
    unknown = set(schema) - KNOWN
    if unknown:
        yield f"{path}: schema keywords {sorted(unknown)} are not known here"
    names = schema.get("type", [])
    names = [names] if isinstance(names, str) else names
    if names and not any(is_type(value, name) for name in names):
        yield f"{path}: {value!r} is no {' or '.join(names)}"
        return
    if "const" in schema and value != schema["const"]:
        yield f"{path}: {value!r} is not {schema['const']!r}"
    if "enum" in schema and value not in schema["enum"]:
        yield f"{path}: {value!r} is none of {schema['enum']}"
    if "oneOf" in schema:
        found = [list(problems(value, one, path)) for one in schema["oneOf"]]
        if sum(not of_one for of_one in found) != 1:
            yield f"{path}: is not exactly one of {len(found)} kinds: {found}"
    if isinstance(value, dict):
        yield from of_object(value, schema, path)
    elif isinstance(value, list):
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
            yield f"{path}: has {len(value)} items"
        for i, item in enumerate(value):
            yield from problems(item, schema.get("items", {}), f"{path}[{i}]")
    elif is_type(value, "number"):
        if value < schema.get("minimum", value) or value > schema.get("maximum", value):
            yield f"{path}: {value} is out of range"
        if "exclusiveMinimum" in schema and value <= schema["exclusiveMinimum"]:
            yield f"{path}: {value} is out of range"


def of_object(value, schema, path):
    for name in schema.get("required", []):
        if name not in value:
            yield f"{path}: lacks {name}"
    others = schema.get("additionalProperties", True)
    for name, item in value.items():
        if name in schema.get("properties", {}):
            yield from problems(item, schema["properties"][name], f"{path}.{name}")
        elif others is False:
            yield f"{path}: {name} is not allowed"
        elif isinstance(others, dict):
            yield from problems(item, others, f"{path}.{name}")
