"""Questions of every kind, drawn."""

from __future__ import annotations

from hypothesis import strategies as st

from semtopo.questions import (
    STOPS_MAX,
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
    Question,
    ReachableQuestion,
    ReachingQuestion,
    SeenQuestion,
    ZonesQuestion,
)


def legs_to(
    goals: st.SearchStrategy[Goal], names: st.SearchStrategy[tuple[Named, ...]]
) -> st.SearchStrategy[tuple[Leg, ...]]:
    """Draw up to four legs that name no more zones than one question may."""
    legs = st.lists(st.builds(Leg, goals, names, names), min_size=1, max_size=4)
    few = legs.filter(lambda drawn: sum(1 + len(leg.via) for leg in drawn) <= STOPS_MAX)
    return few.map(tuple)


def questions_about(
    labels: st.SearchStrategy[str], steps: st.SearchStrategy[int]
) -> st.SearchStrategy[Question]:
    """Draw questions of any kind, with names and steps from these."""
    names = labels.map(Named)
    places = st.one_of(names, st.just(Here()))
    goals = st.one_of(places, st.builds(Nearest, names))
    few_names = st.lists(names, max_size=3).map(tuple)
    legs = legs_to(goals, few_names)
    return st.one_of(
        st.builds(PathQuestion, places, legs),
        st.builds(ConnectionQuestion, places, legs),
        st.builds(DistanceQuestion, places, goals),
        st.builds(NearestQuestion, names, places),
        st.builds(HereQuestion),
        st.builds(LocationQuestion, names),
        st.builds(NeighboursQuestion, places),
        st.builds(ReachableQuestion, places),
        st.builds(ReachingQuestion, places),
        st.builds(SeenQuestion, steps),
        st.builds(ChangesQuestion, steps, st.none() | steps),
        st.builds(ZonesQuestion, st.none() | names),
        st.builds(ClassesQuestion),
        st.builds(FrontiersQuestion, places),
    )
