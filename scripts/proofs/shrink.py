"""Makes a failing world as small as possible without making the failure disappear. Uses delta debugging (Zeller and
Hildebrandt, 2002) on the lists in the document of the world, then removes keys and simplifies numbers one by one."""

import copy
import time


def paths_of(value, path=()):
    """Yields (path, value) of a JSON value and of everything in it, outermost first. A path is a tuple of keys and indices."""
    yield path, value
    if isinstance(value, dict):
        for key in list(value):
            yield from paths_of(value[key], (*path, key))
    elif isinstance(value, list):
        for i, member in enumerate(value):
            yield from paths_of(member, (*path, i))


def at(document, path):
    for token in path:
        document = document[token]
    return document


def put(document, path, value):
    """Returns a copy of the document in which `value` replaces the value at the path."""
    changed = copy.deepcopy(document)
    at(changed, path[:-1])[path[-1]] = value
    return changed


def without(document, path, count=1):
    """Returns a copy of the document without the value at the path. If the path ends in an index of a list, `count` members of
    the list are left out, from this index on."""
    changed = copy.deepcopy(document)
    holder = at(changed, path[:-1])
    if isinstance(holder, list):
        del holder[path[-1]:path[-1] + count]
    else:
        del holder[path[-1]]
    return changed


def exists(document, path):
    try:
        at(document, path)
    except (KeyError, IndexError, TypeError):
        return False
    return True


class Shrinker:
    """shrunk(document) returns a smaller document that still fails. `fails` is a function of a document, which returns whether
    the document still fails. The Shrinker calls this function at most `most_trials` times, and not after `most_s` seconds."""

    def __init__(self, fails, most_trials=1500, most_s=120):
        self._fails, self._left, self._end = fails, most_trials, time.monotonic() + most_s
        self.trials = 0
        self._known = set()

    def _still(self, document):
        if self._left <= 0 or time.monotonic() > self._end:
            return False
        text = repr(document)
        if text in self._known:
            return False
        self._known.add(text)
        self._left -= 1
        self.trials += 1
        return self._fails(document)

    def _lists(self, document):
        """Removes members of lists, many at once if possible."""
        for path, value in list(paths_of(document)):
            if not isinstance(value, list) or not exists(document, path):
                continue
            size = max(1, len(value) // 2)
            while size >= 1:
                i = 0
                while i < len(at(document, path)):
                    smaller = without(document, (*path, i), size)
                    if self._still(smaller):
                        document = smaller
                    else:
                        i += size
                size //= 2
        return document

    def _keys(self, document):
        for path, _ in list(paths_of(document)):
            if path and isinstance(path[-1], str) and exists(document, path):
                smaller = without(document, path)
                if self._still(smaller):
                    document = smaller
        return document

    def _numbers(self, document):
        """Moves whole numbers above 1 towards 0, and rounds other numbers."""
        for path, value in list(paths_of(document)):
            if isinstance(value, bool) or not isinstance(value, (int, float)) or not exists(document, path):
                continue
            while True:
                smaller = next((candidate for candidate in self._smaller(value) if self._still(put(document, path, candidate))), None)
                if smaller is None:
                    break
                document, value = put(document, path, smaller), smaller
        return document

    @staticmethod
    def _smaller(value):
        if isinstance(value, int):
            return dict.fromkeys((0, 1, value // 4, value // 2, value * 3 // 4, value - 1)) if value > 1 else ()
        return [number for number in (0, float(round(value)), round(value, 1)) if abs(number) < abs(value)]

    def shrunk(self, document):
        while True:
            before = repr(document)
            # Large pieces first: their contents then need not be tried.
            for way in (self._lists, self._keys, self._lists, self._numbers):
                document = way(document)
            if repr(document) == before or self._left <= 0 or time.monotonic() > self._end:
                return document
