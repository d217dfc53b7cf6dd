# SPDX-License-Identifier: GPL-3.0-or-later
"""Light Linking and Shadow Linking, as Cycles takes them: which objects a lamp or a mesh lights, and which
cast shadows of its light."""

import functools
from dataclasses import dataclass

import bpy


@dataclass(frozen=True)
class Listed:
    """The objects of a collection, by full name. `states`: (name, whether it is included) of each listed
    object. Where objects are only excluded, all others belong to it; without a collection, all."""

    states: frozenset[tuple[str, bool]] = frozenset()

    @functools.cached_property
    def _of(self):
        return dict(self.states)

    @property
    def names(self):
        return self._of.keys()

    def holds(self, name):
        return self._of.get(name, True not in self._of.values())


@dataclass(frozen=True)
class Linking:
    """The objects that a source of light lights, and those that cast shadows of its light."""

    receivers: Listed = Listed()
    blockers: Listed = Listed()

    def note(self):
        """The same as lists for JSON."""
        return [sorted(map(list, one.states)) for one in (self.receivers, self.blockers)]


ALL = Linking()


def of(obj):
    """The Linking of an original object."""
    linking = obj.light_linking
    return Linking(_listed(linking.receiver_collection), _listed(linking.blocker_collection))


def copied(obj, copy, copies):
    """Gives `copy` the linking of an object, for a scene where the `copies` {object: copy} stand for objects.
    Returns the new collections."""
    made = []
    for name in ("receiver_collection", "blocker_collection"):
        collection = getattr(obj.light_linking, name)
        if collection is None:
            continue
        made.append(bpy.data.collections.new("lamina linking"))
        for one, included in _states(collection).items():
            made[-1].objects.link(copies.get(one, one))
            made[-1].collection_objects[-1].light_linking.link_state = "INCLUDE" if included else "EXCLUDE"
        setattr(copy.light_linking, name, made[-1])
    return made


def names_of(instance, linkings):
    """(name as a receiver, name as a blocker) of an instance of a dependency graph among the Linkings of a
    scene: that of its instancer, if one of them lists it."""
    own = instance.object.original.name_full
    by = instance.parent.original.name_full if instance.is_instance else own
    lists = zip(*((one.receivers, one.blockers) for one in linkings), strict=True)
    return tuple(by if any(by in one.names for one in each) else own for each in lists)


def _listed(collection):
    states = {} if collection is None else _states(collection)
    return Listed(frozenset((obj.name_full, included) for obj, included in states.items()))


def _states(collection):
    """{object: whether it is included}. All objects of a child collection have the child's state, unless they
    are also listed by themselves."""
    states = {}
    for child, member in zip(collection.children, collection.collection_children, strict=True):
        states |= dict.fromkeys(child.all_objects, member.light_linking.link_state)
    for obj, member in zip(collection.objects, collection.collection_objects, strict=True):
        states[obj] = member.light_linking.link_state
    return {obj: state == "INCLUDE" for obj, state in states.items()}
