"""Answers to questions: each holds structure, and the same as a sentence.

In come an atlas and a question, in words or as a value; out goes an answer, or the reason why there
is none.
"""

from __future__ import annotations

from semtopo.answers.past import History, answer_past
from semtopo.answers.places import answer_place
from semtopo.answers.understanding import understand
from semtopo.answers.values import Answer
from semtopo.answers.ways import answer_way
from semtopo.atlas import Atlas
from semtopo.journey import ANY_WAY, WayOptions
from semtopo.questions import (
    ChangesQuestion,
    ConnectionQuestion,
    DistanceQuestion,
    NearestQuestion,
    PathQuestion,
    Question,
    SeenQuestion,
)

__all__ = ["Answer", "History", "answer", "answer_question", "understand"]


def answer(
    atlas: Atlas, text: str, history: History | None = None, options: WayOptions = ANY_WAY
) -> Answer:
    """Answer a sentence; `options` say how the robot goes.

    Raises
    ------
    InvalidQuestionError
        It leaves the grammar.
    AmbiguousQuestionError
        It asks different things, as names of the map may be read.
    SemtopoError
        As `answer_question` does.
    """
    return answer_question(atlas, understand(atlas, text), history, options)


def answer_question(
    atlas: Atlas,
    question: Question,
    history: History | None = None,
    options: WayOptions = ANY_WAY,
) -> Answer:
    """Answer a question; `history` gives earlier maps, if there are any at hand.

    `options` say how the robot goes; with a radius, ways come with a path for it.

    Raises
    ------
    UnknownZoneError, AmbiguousZoneError
        A name means no zone, or several where one is asked for.
    NoRouteError
        There is no way.
    OutsideError, TooNarrowError, NotConnectedError
        There is a way, but not for a robot of that radius.
    UnknownPositionError
        The question is about where the robot is, which is not known.
    UnknownStepError
        The question is about a step that was not taken, or of which nothing is known.
    UnknownBorderError
        The question is about frontiers, in a map without borders.
    """
    match question:
        case PathQuestion() | ConnectionQuestion() | DistanceQuestion() | NearestQuestion():
            return answer_way(atlas, question, options)
        case SeenQuestion() | ChangesQuestion():
            return answer_past(atlas, question, history)
        case _:
            return answer_place(atlas, question)
