"""Decks as data: reading them, and changing single keys by path with the schema that `amontons schema` prints.

A path names a key as in `mesh.parameters.h` or `contact[0].enforce.penalty.alpha`; list entries count from 0, and [*]
stands for all of them.
"""

import copy
import difflib
import re

import yaml


class StudyError(Exception):
    """What is wrong with what the user asked for, where, and what to do."""


class DeckLoader(yaml.SafeLoader):
    """YAML 1.1 takes the key `on` for a truth value; a deck means the word."""


DeckLoader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in resolvers if tag != "tag:yaml.org,2002:bool"]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
}


def read_yaml(path):
    """The mapping in a YAML file. Errors: StudyError with file and place."""
    try:
        with open(path, encoding="utf-8") as file:
            content = yaml.load(file, Loader=DeckLoader)
    except OSError as error:
        raise StudyError(f"{path} cannot be read: {error.strerror}.") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise StudyError(f"{path} is not valid YAML: {error}") from error
    if not isinstance(content, dict):
        raise StudyError(f"{path} must hold keys and values, like `deck: hertz_2d.yaml`.")
    return content


def nearest(name, known):
    """' Did you mean ...?' for the known name that is most like `name`, or ''."""
    found = difflib.get_close_matches(str(name), [str(other) for other in known], n=1, cutoff=0.5)
    return f" Did you mean '{found[0]}'?" if found else ""


def split_path(path):
    """Keys of a path: text for maps, integers for lists. Errors: StudyError for a path that cannot be read."""
    if not re.fullmatch(r"[^\[\].]+(\[\d+\]|\.[^\[\].]+)*", path):
        raise StudyError(f"'{path}' is not a path. Write keys with dots and list entries in brackets, "
                         "as in contact[0].enforce.penalty.alpha.")
    return [int(entry) if entry else key for entry, key in re.findall(r"\[(\d+)\]|([^\[\].]+)", path)]


def expand(deck, path):
    """The paths that one with [*] stands for in a deck: one for each entry of the list."""
    before, star, after = path.partition("[*]")
    if not star:
        return [path]
    entries = get_value(deck, before)
    if not isinstance(entries, list) or not entries:
        raise StudyError(f"unknown knob '{path}': '{before}' is no list with entries in the deck.")
    return [whole for i in range(len(entries)) for whole in expand(deck, f"{before}[{i}]{after}")]


def flattened(schemas):
    """The alternatives of JSON schemas, without `anyOf` around them."""
    found = []
    for schema in schemas:
        found += flattened(schema["anyOf"]) if "anyOf" in schema else [schema]
    return found


def allows(schema, key):
    """The schema of `key` below an object's or array's schema, or None."""
    if isinstance(key, int):
        return schema.get("items")
    below = schema.get("properties", {}).get(key)
    free = schema.get("additionalProperties")
    return below if below is not None else free if isinstance(free, dict) else None


def leaves(value, path=""):
    """Paths of all values in a deck that are neither map nor list."""
    if isinstance(value, dict):
        return [leaf for key, item in value.items() for leaf in leaves(item, f"{path}.{key}" if path else str(key))]
    if isinstance(value, list):
        return [leaf for i, item in enumerate(value) for leaf in leaves(item, f"{path}[{i}]")]
    return [path]


def unknown_key(deck, schemas, path, keys, at):
    where = f" in '{join_path(keys[:at])}'" if at else ""
    known = sorted({name for schema in schemas for name in schema.get("properties", {})})
    hint = nearest(keys[at], known) or nearest(path, leaves(deck))
    if not hint:
        same_end = [leaf for leaf in leaves(deck) if split_path(leaf)[-1] == keys[-1]]
        hint = f" Did you mean '{same_end[0]}'?" if same_end else f" Known there: {', '.join(known) or 'nothing'}."
    return StudyError(f"unknown knob '{path}': a deck has no '{keys[at]}'{where}.{hint}")


def join_path(keys):
    return "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in keys).lstrip(".")


def check_path(deck, schema, path):
    """Is there such a key in a deck like this one? Errors: StudyError with the nearest match."""
    if "[*]" in path:
        for whole in expand(deck, path):
            check_path(deck, schema, whole)
        return
    keys, schemas, place = split_path(path), [schema], deck
    for at, key in enumerate(keys):
        schemas = flattened(schemas)
        below = [found for found in (allows(other, key) for other in schemas) if found is not None]
        if not below:
            raise unknown_key(deck, schemas, path, keys, at)
        if isinstance(key, int) and (not isinstance(place, list) or key >= len(place)):
            count = len(place) if isinstance(place, list) else 0
            raise StudyError(f"unknown knob '{path}': '{join_path(keys[:at])}' has {count} "
                             f"entr{'y' if count == 1 else 'ies'} in the deck, counted from 0.")
        place = place.get(key) if isinstance(place, dict) else place[key] if isinstance(key, int) else None
        schemas = below


def set_value(deck, schema, path, value):
    """Sets the key at `path`. What stands on the way and belongs to another alternative gives way: in a deck with
    `enforce: {semismooth: {}}`, setting `enforce.penalty.alpha` leaves `enforce: {penalty: {alpha: ...}}`."""
    keys, schemas, place = split_path(path), [schema], deck
    for key, following in zip(keys[:-1], keys[1:]):
        schemas = [found for found in (allows(other, key) for other in flattened(schemas)) if found is not None]
        child = place.get(key) if isinstance(place, dict) else place[key]
        if not isinstance(child, (dict, list)):
            child = {}
        if isinstance(child, dict):
            kept = [other for other in flattened(schemas) if allows(other, following) is not None]
            child = {name: item for name, item in child.items()
                     if any(allows(other, name) is not None for other in kept)}
        place[key] = child
        place = child
    place[keys[-1]] = copy.deepcopy(value)


def get_value(deck, path):
    """The value at `path`, or None where there is none."""
    for key in split_path(path):
        try:
            deck = deck[key]
        except (KeyError, IndexError, TypeError):
            return None
    return deck


def remove_value(deck, path):
    """Takes the key at `path` out; nothing happens where there is none."""
    keys = split_path(path)
    parent = get_value(deck, join_path(keys[:-1])) if len(keys) > 1 else deck
    if isinstance(parent, dict):
        parent.pop(keys[-1], None)
