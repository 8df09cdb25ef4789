"""The grammar of questions (section 1: "by the means of semantic sentences"), and its parser.

Names stand in quotation marks, or bare between the words of the grammar. The parser is LALR(1): its
time grows with the length of a sentence and no faster, whatever the sentence.
"""

from __future__ import annotations

import re
from functools import cache

from lark import Lark

GRAMMAR = r"""
start: _POLITE* question _PLEASE?

?question: _WAY trip                             -> path
    | _IS_THERE trip                             -> connection
    | _IS place _REACHED _FROM place             -> reachability
    | _HOW_FAR ends                              -> distance
    | _HOW_FAR place [_FROM place]               -> remoteness
    | _NEAREST name [_FROM place]                -> nearest_zone
    | _WHERE_AM_I                                -> position
    | _WHERE_IS name                             -> location
    | _NEXT_TO place                             -> neighbours
    | _REACHABLE_FROM place                      -> reachable
    | _LEADS_TO place                            -> reaching
    | _FROM_WHICH place _REACHED                 -> reaching
    | _SEEN _AT step                             -> seen
    | _CHANGED _BETWEEN step _AND step           -> changes
    | _CHANGED _FROM step _TO step               -> changes
    | _CHANGED _SINCE step                       -> changes
    | _LIST_ZONES [_OF_CLASS name]               -> zones
    | _LIST_CLASSES                              -> classes
    | _UNEXPLORED _IN place                      -> frontiers

trip: ends clause* leg*
ends: _FROM place _TO goal                       -> onwards
    | _TO goal [_FROM place]                     -> backwards
    | _BETWEEN place _AND goal                   -> onwards
leg: _THEN goal clause*
clause: _VIA names                               -> via
    | _AVOIDING names                            -> avoiding
names: name (_AND name)*
?goal: _NEAREST name                             -> nearest
    | place
?place: _HERE                                    -> here
    | name
?name: WORD+                                     -> words
    | QUOTED                                     -> quoted
?step: _STEP? NUMBER                             -> number

_POLITE: /(please|kindly|((can|could|will|would) you)|((show|tell|give|find) me)),?/
_PLEASE.2: /,?\s*(please|thanks|thank you|now)/
_WAY.2: /((the|a|an) )?((shortest|best|quickest|fastest) )?(path|way|route|directions)/
    | /((i|we) (want|need|have|would like) to )?(go|get|come|drive|walk|travel|navigate)( back)?/
    | /how (do|can|could|would|should) (i|we|you|one) (get|go|come|drive|walk|travel)/
    | /(how|where) to (get|go)/ | /(take|bring|lead|guide|drive|send) (me|us|it|the robot)/
_IS_THERE.3: /is there (a|any|some|no) (path|way|route|connection)/
    | /(can|could) (i|we|one) (get|go|come|drive|walk|travel)/
_IS: /(is|are)/
_HOW_FAR.2: /how (far|long)( away)?( (is|are)( (it|(the|a) (path|way|route)))?)?/
    | /(what is )?(the )?distance/ | /what is the length of the (path|way|route)/
_NEAREST.3: /((which|what|where) is )?((the|a|an) )?(nearest|closest)( (zone|room) of class)?/
_WHERE_AM_I.4: /where (am i|are (we|you)|is the robot)/ | /(what|which) (zone|room) is this/
    | /(in )?(what|which) (zone|room) (am i|are (we|you)|is the robot)( in)?/
_WHERE_IS: /where('s| is| are)/
_NEXT_TO.3: /((what|who|which (zones?|rooms?))('s| is| are| lies| lie) )?(next to|beside|near)/
    | /((what are|which are|list) )?(the )?neighbou?rs of/ | /what (borders|adjoins)/
_REACHABLE_FROM.3: /((what|which (zones|rooms)) (is|are) )?(reachable|accessible) from/
    | /(what|which (zones|rooms)) can (i|we|one|you) (reach|get to|go to) from/
    | /where can (i|we|one|you) (get|go)( to)? from/
    | /(what|which (zones|rooms)) can be (reached|accessed) from/
_LEADS_TO.3: /(what|which (zones|rooms)) (leads?|goe?s?) to/
    | /from (where|(which|what) (zones|rooms)) can (i|we|one|you) (reach|get to|go to)/
_FROM_WHICH.2: /from (where|(which|what) (zones|rooms)) (can|is|are)/
_REACHED: /(be )?(reached|accessed|reachable|accessible)/
_SEEN.2: /what (did|do|could) (i|we|you|it|the robot) (see|find|discover)/
    | /what (was|has been) (seen|found|discovered)/
_AT: /(at|in|on|during)( the)?/
_CHANGED.2: /what( has| have)? changed/ | /((list|what are) )?(the )?changes/
    | /what is (new|different)/
_SINCE: /(since|after)( the)?/
_LIST_ZONES: /((list|show|name|what are|which are) )?(all )?(of )?(the )?(zones|rooms)( are there)?/
    | /(what|which) (zones|rooms)( are there| exist)?/
_LIST_CLASSES: /((list|show|name|what are|which are) )?(all )?(of )?(the )?classes( are there)?/
    | /(what|which) classes( of (zones|rooms))?( are there| exist)?/
_OF_CLASS: /(of|with|in)( the)? class/
_UNEXPLORED.3: /what('s| is)( still| yet)? (unexplored|unknown|not explored)( yet)?/
    | /((list|what are|where are) )?(the )?(frontiers|unexplored (parts|places))/
_IN: /(in|of|inside)/
_FROM: /(from|starting (from|at|in))/
_TO: /(to|into|towards?)/
_BETWEEN: /between( the)?/
_VIA.2: /(,\s*)?(and )?(via|through|by way of|(going|passing) through)/
_AVOIDING.2: /(,\s*)?(and )?(avoiding|without( passing( through)?)?|(but )?not (via|through))/
_THEN.2: /(,\s*)?(and )?(then|after that)( (go|on|go on|drive|walk|continue))?( to)?/
_AND.1: /(,\s*)?and/ | /,/
_HERE.1: /(here|me|my (place|position)|where i am|this (zone|room|place))/
_STEP: /(the )?(steps?|scans?)/
NUMBER: /[0-9]{1,9}/
QUOTED.1: /"([^"]|"")+"/ | /“[^”]+”/ | /„[^“”]+[“”]/ | /«[^»]+»/ | /\u2018[^\u2019]+\u2019/
    | /'([^']|'(?=\w))+'/
WORD.-1: /[^\s,"“”„«»\u2018]([^\s,]|,(?=[^\s,]))*/

%ignore /\s+/
"""
"""What is understood.

In a terminal a space stands for any white space, case does not matter, and it ends only where a
word does. A terminal with an underscore before it says nothing but where it stands.
"""

_TERMINAL = re.compile(r"^(_?[A-Z]|    \| /)")
_PATTERN = re.compile(r"/(.+?)/(?=$| \|)")


@cache
def parser() -> Lark:
    """Return the parser of questions; it is made once."""
    return Lark("\n".join(map(_complete, GRAMMAR.splitlines())), parser="lalr")


@cache
def reserved_words() -> frozenset[str]:
    """Return the words, in small letters, that may be more than a part of a name."""
    keywords = (one.pattern.value for one in parser().terminals if one.name.startswith("_"))
    return frozenset(word for pattern in keywords for word in re.findall(r"(?<!\\)[a-z]+", pattern))


def _complete(line: str) -> str:
    """Return a line of the grammar, its patterns as lark must have them."""
    if _TERMINAL.match(line) is None:
        return line
    return _PATTERN.sub(_completed, line)


def _completed(pattern: re.Match[str]) -> str:
    spaced = pattern[1].replace(" ", r"\s+")
    return rf"/(?:{spaced})(?=[\s,]|$)/i"
