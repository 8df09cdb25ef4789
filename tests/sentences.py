"""A corpus of sentences: what each asks, or where it leaves the grammar and what is missing there.

`H` is the place where the robot is.
"""

from __future__ import annotations

from semtopo.questions import (
    ChangesQuestion,
    ClassesQuestion,
    ConnectionQuestion,
    DistanceQuestion,
    FrontiersQuestion,
    Goal,
    Here,
    HereQuestion,
    Leg,
    LocationQuestion,
    Named,
    Nearest,
    NearestQuestion,
    NeighboursQuestion,
    PathQuestion,
    Place,
    Question,
    ReachableQuestion,
    ReachingQuestion,
    SeenQuestion,
    ZonesQuestion,
)

H = Here()


def place(it: str | Here) -> Place:
    return it if isinstance(it, Here) else Named(it)


def near(zone_class: str) -> Nearest:
    return Nearest(Named(zone_class))


def leg(goal: str | Goal, via: str = "", avoiding: str = "") -> Leg:
    """Return a leg; names in `via` and `avoiding` have commas between."""
    names = [tuple(Named(it) for it in given.split(",") if it) for given in (via, avoiding)]
    return Leg(Named(goal) if isinstance(goal, str) else goal, *names)


def path(start: str | Here, goal: str | Goal, via: str = "", avoiding: str = "") -> PathQuestion:
    return PathQuestion(place(start), (leg(goal, via, avoiding),))


def tour(start: str | Here, *legs: Leg) -> PathQuestion:
    return PathQuestion(place(start), legs)


def link(start: str | Here, goal: str | Goal, via: str = "", avoiding: str = "") -> Question:
    return ConnectionQuestion(place(start), (leg(goal, via, avoiding),))


def far(start: str | Here, goal: str | Goal) -> DistanceQuestion:
    return DistanceQuestion(place(start), Named(goal) if isinstance(goal, str) else goal)


UNDERSTOOD: list[tuple[str, Question]] = [
    # paths
    ("path from corridor to C", path("corridor", "C")),
    ("Path from corridor to C.", path("corridor", "C")),
    ("PATH FROM corridor TO C", path("corridor", "C")),
    ("the path from a to b?", path("a", "b")),
    ("A path from a to b!", path("a", "b")),
    ("  path   from   a   to   b  ", path("a", "b")),
    ("path\tfrom a\nto b", path("a", "b")),
    ("path to C from corridor", path("corridor", "C")),
    ("path to C", path(H, "C")),
    ("path from here to C", path(H, "C")),
    ("path between a and b", path("a", "b")),
    ("way from a to b", path("a", "b")),
    ("the shortest way from a to b", path("a", "b")),
    ("route from a to b", path("a", "b")),
    ("directions from a to b", path("a", "b")),
    ("how do I get from a to b", path("a", "b")),
    ("How do I get to b?", path(H, "b")),
    ("how can one get from a to b", path("a", "b")),
    ("how to get to b", path(H, "b")),
    ("go from a to b", path("a", "b")),
    ("go to b", path(H, "b")),
    ("Go to the kitchen!", path(H, "kitchen")),
    ("drive to b", path(H, "b")),
    ("go back to b", path(H, "b")),
    ("take me to b", path(H, "b")),
    ("I want to go to b", path(H, "b")),
    ("please go to b", path(H, "b")),
    ("go to b, please", path(H, "b")),
    ("Please, show me the way to b.", path(H, "b")),
    ("can you show me the path from a to b", path("a", "b")),
    ("Could you please tell me how to get to b?", path(H, "b")),
    ("navigate to a from b", path("b", "a")),
    ("path from a to here", path("a", H)),
    ("path from where I am to b", path(H, "b")),
    ("go to the nearest office", path(H, near("office"))),
    ("path from a to the closest coffee kitchen", path("a", near("coffee kitchen"))),
    ("path from a to a", path("a", "a")),
    # names
    ("path from living room to kitchen", path("living room", "kitchen")),
    ("path from the living room to the kitchen", path("living room", "kitchen")),
    ("path from a kitchen to an office", path("kitchen", "office")),
    ("path from the to a", path("the", "a")),
    ('path from "living room" to "the kitchen"', path("living room", "the kitchen")),
    ("path from 'living room' to 'the kitchen'", path("living room", "the kitchen")),
    ("path from “living room” to “the kitchen”", path("living room", "the kitchen")),
    ("path from „living room“ to «the kitchen»", path("living room", "the kitchen")),
    ("path from \u2018living room\u2019 to \u2018b\u2019", path("living room", "b")),
    ('path from "way to go" to b', path("way to go", "b")),
    ('path from a to "way to go"', path("a", "way to go")),
    ('path from "a to b" to "c to d"?', path("a to b", "c to d")),
    ('path from "path from x to y" to z', path("path from x to y", "z")),
    ('path from "here" to b', path("here", "b")),
    ("path from Küche to 厨房", path("Küche", "厨房")),
    ("path from 🤖 to é", path("🤖", "é")),
    ("path from tomato to potato", path("tomato", "potato")),
    ("path from r1-1 to r1-2", path("r1-1", "r1-2")),
    ("path from room 12 to room 14", path("room 12", "room 14")),
    ('path from "C." to "D?"', path("C.", "D?")),
    ('path from " a " to b', path("a", "b")),
    ('path from "say ""hi""" to b', path('say "hi"', "b")),
    ("path from O'Brien's to b", path("O'Brien's", "b")),
    ("path from 'O'Brien's' to b", path("O'Brien's", "b")),
    ("path from path to from", path("path", "from")),
    ("path from via to to", path("via", "to")),
    ("path from please to b", path("please", "b")),
    ("path from to to b", path("to", "b")),
    ("path from 1,2 to 3,4", path("1,2", "3,4")),
    ("path from Dr. No to b", path("Dr. No", "b")),
    ("path from Аудитория to Коридор", path("Аудитория", "Коридор")),
    # stops
    ("path from a to b via c", path("a", "b", via="c")),
    ("path from a to b through c", path("a", "b", via="c")),
    ("path from a to b via c and d", path("a", "b", via="c,d")),
    ("path from a to b via c, d and e", path("a", "b", via="c,d,e")),
    ("path from a to b via c, d, and e", path("a", "b", via="c,d,e")),
    ("path from a to b, via c", path("a", "b", via="c")),
    ("path from a to b via the hall and the big room", path("a", "b", via="hall,big room")),
    ('path from a to b via "c and d"', path("a", "b", via="c and d")),
    ("path from a to b avoiding c", path("a", "b", avoiding="c")),
    ("path from a to b avoiding c and d", path("a", "b", avoiding="c,d")),
    ("path from a to b without c", path("a", "b", avoiding="c")),
    ("path from a to b without passing through c", path("a", "b", avoiding="c")),
    ("path from a to b but not through c", path("a", "b", avoiding="c")),
    ("path from a to b via c avoiding d", path("a", "b", via="c", avoiding="d")),
    ("path from a to b via c and avoiding d", path("a", "b", via="c", avoiding="d")),
    ("path from a to b avoiding d, via c", path("a", "b", via="c", avoiding="d")),
    ("path from a to b via c via d", path("a", "b", via="c,d")),
    ("go to b avoiding the stairs", path(H, "b", avoiding="stairs")),
    ("path to b from a via c", path("a", "b", via="c")),
    ("path from a to b and then to c", tour("a", leg("b"), leg("c"))),
    ("path from a to b, then c", tour("a", leg("b"), leg("c"))),
    ("path from a to b then to c", tour("a", leg("b"), leg("c"))),
    ("go to a and then go to b", tour(H, leg("a"), leg("b"))),
    ("go to a, after that to b", tour(H, leg("a"), leg("b"))),
    ("go to a and then here", tour(H, leg("a"), leg(H))),
    (
        "path from a to b via c and then to d avoiding e and then to the nearest office",
        tour("a", leg("b", via="c"), leg("d", avoiding="e"), leg(near("office"))),
    ),
    ("path from a to b via here", path("a", "b", via="here")),
    # connections
    ("is there a way from a to b", link("a", "b")),
    ("Is there a path from a to b via c avoiding d?", link("a", "b", "c", "d")),
    ("is there any route to b", link(H, "b")),
    ("is there a way between a and b", link("a", "b")),
    ("can I get from a to b", link("a", "b")),
    ("can I go to b", link(H, "b")),
    ("is b reachable from a", link("a", "b")),
    ("is the kitchen accessible from here", link(H, "kitchen")),
    ("is there a way to the nearest exit", link(H, near("exit"))),
    # distances
    ("how far is b from a", far("a", "b")),
    ("how far is b", far(H, "b")),
    ("how far is the kitchen from here", far(H, "kitchen")),
    ("how far is it from a to b", far("a", "b")),
    ("how far is it to b?", far(H, "b")),
    ("how far away is b", far(H, "b")),
    ("distance from a to b", far("a", "b")),
    ("what is the distance between a and b", far("a", "b")),
    ("how long is the way from a to b", far("a", "b")),
    ("how far is it to the nearest office", far(H, near("office"))),
    # the nearest
    ("nearest office", NearestQuestion(Named("office"))),
    ("nearest office from here", NearestQuestion(Named("office"), H)),
    ("the nearest office from a", NearestQuestion(Named("office"), Named("a"))),
    ("where is the nearest office?", NearestQuestion(Named("office"))),
    ("which is the closest office from a", NearestQuestion(Named("office"), Named("a"))),
    ("nearest room of class meeting room", NearestQuestion(Named("meeting room"))),
    ('nearest "office"', NearestQuestion(Named("office"))),
    ("nearest here", NearestQuestion(Named("here"))),
    # where
    ("where am I", HereQuestion()),
    ("Where am I?", HereQuestion()),
    ("where are you", HereQuestion()),
    ("where is the robot?", HereQuestion()),
    ("in which room am I", HereQuestion()),
    ("what room is this", HereQuestion()),
    ("can you tell me where am I", HereQuestion()),
    ("where is C", LocationQuestion(Named("C"))),
    ("where's the kitchen?", LocationQuestion(Named("kitchen"))),
    ("where are the offices", LocationQuestion(Named("offices"))),
    ('where is "the robot"', LocationQuestion(Named("the robot"))),
    # what is next to what
    ("what is next to C", NeighboursQuestion(Named("C"))),
    ("What's next to the kitchen?", NeighboursQuestion(Named("kitchen"))),
    ("which zones are next to C", NeighboursQuestion(Named("C"))),
    ("what is beside here", NeighboursQuestion(H)),
    ("next to me", NeighboursQuestion(H)),
    ("neighbours of C", NeighboursQuestion(Named("C"))),
    ("list the neighbors of C", NeighboursQuestion(Named("C"))),
    ("what borders C", NeighboursQuestion(Named("C"))),
    ("which zones are reachable from C", ReachableQuestion(Named("C"))),
    ("what can I reach from C", ReachableQuestion(Named("C"))),
    ("where can I go from here", ReachableQuestion(H)),
    ("which rooms can be reached from C", ReachableQuestion(Named("C"))),
    ("reachable from C", ReachableQuestion(Named("C"))),
    ("from which zones can C be reached", ReachingQuestion(Named("C"))),
    ("from where can C be reached", ReachingQuestion(Named("C"))),
    ("from which rooms is C accessible", ReachingQuestion(Named("C"))),
    ("from which zones can I reach C", ReachingQuestion(Named("C"))),
    ("which zones lead to C", ReachingQuestion(Named("C"))),
    ("what leads to here", ReachingQuestion(H)),
    # steps
    ("what did I see at step 5", SeenQuestion(5)),
    ("what did you see in step 5?", SeenQuestion(5)),
    ("what was found at 5", SeenQuestion(5)),
    ("What did I see at the step 007", SeenQuestion(7)),
    ("what changed between step 5 and 29", ChangesQuestion(5, 29)),
    ("what changed between steps 5 and 29", ChangesQuestion(5, 29)),
    ("what has changed between step 5 and step 29?", ChangesQuestion(5, 29)),
    ("what changed from step 5 to step 29", ChangesQuestion(5, 29)),
    ("changes between 5 and 29", ChangesQuestion(5, 29)),
    ("what changed since step 5", ChangesQuestion(5)),
    ("what is new since 5", ChangesQuestion(5)),
    ("list changes since step 0", ChangesQuestion(0)),
    # lists
    ("list zones", ZonesQuestion()),
    ("List all the zones.", ZonesQuestion()),
    ("show me all zones", ZonesQuestion()),
    ("which zones are there?", ZonesQuestion()),
    ("list rooms of class office", ZonesQuestion(Named("office"))),
    ("list zones of the class meeting room", ZonesQuestion(Named("meeting room"))),
    ("which zones are there of class 'office'", ZonesQuestion(Named("office"))),
    ("zones in class office please", ZonesQuestion(Named("office"))),
    ("list classes", ClassesQuestion()),
    ("which classes are there", ClassesQuestion()),
    ("what classes of zones are there?", ClassesQuestion()),
    # what is unexplored
    ("what is unexplored in C", FrontiersQuestion(Named("C"))),
    ("What is still unknown in the corridor?", FrontiersQuestion(Named("corridor"))),
    ("frontiers of C", FrontiersQuestion(Named("C"))),
    ("where are the frontiers in here", FrontiersQuestion(H)),
    ("list the unexplored parts of C", FrontiersQuestion(Named("C"))),
]

A_QUESTION = 'a question such as "path from corridor to C", "where am I" or "list zones"'
A_LIST = '"via", "avoiding", "and then to" or the end of the question'
A_MARK = "the mark that ends the quotation"

REFUSED: list[tuple[str, int, str]] = [
    # no question at all
    ("", 0, A_QUESTION),
    ("   ", 0, A_QUESTION),
    ("?!", 0, A_QUESTION),
    ("please", 6, A_QUESTION),
    ("hello", 0, A_QUESTION),
    ("what", 0, A_QUESTION),
    ("what is the weather", 0, A_QUESTION),
    ("list the offices", 0, A_QUESTION),
    ("to b", 0, A_QUESTION),
    ("from a to b", 0, A_QUESTION),
    ('"path from a to b"', 0, A_MARK),
    ("pth from a to b", 0, A_QUESTION),
    ("paths from a to b", 0, A_QUESTION),
    ("please, hello", 8, A_QUESTION),
    ("path, from a to b", 4, '"to", "from" or "between"'),
    # a way without its ends
    ("path", 4, '"to", "from" or "between"'),
    ("go", 2, '"to", "from" or "between"'),
    ("how do I get", 12, '"to", "from" or "between"'),
    ("path a to b", 5, '"to", "from" or "between"'),
    ("patha from a to b", 0, A_QUESTION),
    ("path froma to b", 5, '"to", "from" or "between"'),
    ("path from", 9, 'a name or "here"'),
    ("path from a", 11, '"to"'),
    ("path from a b", 13, '"to"'),
    ("path from ato b", 15, '"to"'),
    ("path from a to", 14, 'a name, "here" or "the nearest"'),
    ("path from a to ", 14, 'a name, "here" or "the nearest"'),
    ("path from a to?", 14, 'a name, "here" or "the nearest"'),
    ("path from a via b", 12, '"to"'),
    ("path from a, to b", 11, '"to"'),
    ("path between a", 14, '"and"'),
    ("path between a to b", 15, '"and"'),
    ("path from a to the nearest", 26, "a name"),
    # stops that do not stop
    ("path from a to b via", 20, "a name"),
    ("path from a to b via c and", 26, "a name"),
    ("path from a to b avoiding", 25, "a name"),
    ("path from a to b and then", 25, 'a name, "here" or "the nearest"'),
    ("path from a to b and c", 17, A_LIST),
    ("path from a to b,, via c", 16, A_LIST),
    ("path from a to b to c", 17, A_LIST),
    ('path from a to "b" c', 19, A_LIST),
    ("path from a to b from c", 17, A_LIST),
    # marks
    ('path from "a to b', 10, A_MARK),
    ("path from a to “b", 15, A_MARK),
    ('path from "a" to "b', 17, A_MARK),
    ('path from ""', 10, A_MARK),
    # other questions
    ("is C", 4, '"reachable" or "be reached"'),
    ("is C reachable", 14, '"from"'),
    ("is there a way", 14, '"to", "from" or "between"'),
    ("how far", 7, 'a name, "here", "to", "from" or "between"'),
    ("how far is b via c", 13, '"from" or the end of the question'),
    ("how far is it from a to b via c", 26, "the end of the question"),
    ("nearest", 7, "a name"),
    ("where is", 8, "a name"),
    ("what is next to", 15, 'a name or "here"'),
    ("which zones are reachable from", 30, 'a name or "here"'),
    ("from which zones can C", 22, '"reachable" or "be reached"'),
    ("from which zones can C be seen", 30, '"reachable" or "be reached"'),
    ("what did I see", 14, '"at step"'),
    ("what did I see at", 17, "the number of a step"),
    ("what did I see at step x", 23, "the number of a step"),
    ("what did I see at step -1", 23, "the number of a step"),
    ("what did I see at step 1.5", 23, "the number of a step"),
    ("what did I see at step 10000000000", 23, "the number of a step"),
    ("what did I see at step 5 and 6", 25, "the end of the question"),
    ("what changed", 12, '"from", "between" or "since step"'),
    ("what changed between step 5", 27, '"and"'),
    ("what changed since", 18, "the number of a step"),
    ("what changed since breakfast", 19, "the number of a step"),
    ("list zones of class", 19, "a name"),
    ("list zones of size 3", 11, '"of class" or the end of the question'),
    ("list classes of", 13, "the end of the question"),
    ("what is unexplored", 18, '"in"'),
    ("what is unexplored in", 21, 'a name or "here"'),
    ("where am I going", 11, "the end of the question"),
    # crowds
    ("go to a" + " and then to b" * 8, 7 + 14 * 7 + 13, "at most 8 zones to go to or through"),
    ("go to a via b" + " and c" * 7, 13 + 6 * 6 + 5, "at most 8 zones to go to or through"),
    ("go to a avoiding b" + ", c" * 64, 18 + 3 * 63 + 2, "at most 64 zones to avoid"),
]
"""Sentences with the place in characters where they leave the grammar, and what belongs there."""
