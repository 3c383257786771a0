"""What a render cannot show as Blender would: one sentence a kind, with a count and names."""

MOST_NAMES = 4


class Lost:
    def __init__(self):
        self._names = {}

    def add(self, kind, name):
        """``kind``: a clause such as "hair, which is left out"; ``name``: of the thing that has it."""
        names = self._names.setdefault(kind, [])
        if name not in names:
            names.append(name)

    def lines(self):
        lines = []
        for kind, names in self._names.items():
            some = ", ".join(names[:MOST_NAMES]) + (", ..." if len(names) > MOST_NAMES else "")
            lines.append("%d with %s: %s" % (len(names), kind, some))
        return lines
