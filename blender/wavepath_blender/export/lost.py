"""What a render cannot show as Blender would: one line a kind, with a count and names."""

MOST_NAMES = 4


class Lost:
    def __init__(self):
        self._names = {}

    def add(self, kind, name):
        """``kind``: what it is and what becomes of it, as in "hair: left out"; ``name``: of the thing that has it."""
        names = self._names.setdefault(kind, [])
        if name not in names:
            names.append(name)

    def lines(self):
        return [line(kind, names) for kind, names in self._names.items()]


def line(kind, names):
    some = ", ".join(names[:MOST_NAMES]) + (", ..." if len(names) > MOST_NAMES else "")
    return "%s (%d: %s)" % (kind, len(names), some)
