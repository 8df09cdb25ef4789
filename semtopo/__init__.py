"""Turn a robot's steps into zones, a graph of zones and answers.

The flow of one step, from value to value:

    World -> Measurement -> Scan -> SensorMap -> MetricMap + TopologyGraph -> Route

It implements Figurowski & Dworak, "An algorithm for modeling an environment and creating a semantic
model of its topology", Procedia Computer Science 192 (2021) 612-621. The paper's symbols are here:

    M_w, z_w  World, WorldZone          M_u, z_u  SensorMap, Zone
    U_s       Sensor                    M_m, z_m  MetricMap, MappedZone
    p_r       position                  M_s, E    TopologyGraph, Passage
    U_xy      Measurement               s_r       here
    U_r       Scan

Nothing in this package does I/O, reads a clock, draws a random number, or logs: same input, same
output.

Readings of the paper, where it is silent or misprinted; each is cited at its line:

    R1   beam i looks along 2 pi (i - 1) / u_sD, clockwise from +y
    R2   a beam ends at its first obstacle sample
    R3   a passage sample makes no zone, also before an obstacle
    R4   later rectangles lie on top; they are closed; outside of all is obstacle; the robot's own
         place is not sampled; at least two samples on a beam
    R5   a change of label without a passage between is a passage of no width
    R6   a zone is the union of the strips between neighbouring beams
    R7   the nearest zone: least distance to its polygon, ties by label
    R8   a scan without zones changes nothing, and counts
    R9   a zone may have any area above `min_zone_area`
    R10  the first passage between two zones stays; or `all` do, one through each doorway, whose
         number it has: pieces of doorways that touch are one doorway
    R11  a passage point is the point of the zone that is nearest to the robot
    R12  zones fuse by polygon union; they may have holes and several parts
    R13  kind `unknown`: seen, not labelled; neither obstacle nor zone nor passage; what begins
         behind it begins with occupancy `free`
    R14  one label is one zone; or each place of it is an `instance`: zones of one label that touch,
         or that a later scan joins, are one, and the one found first stays
    R15  edges: to every zone `seen`, or only between zones `adjacent` along beams: both beams of a
         strip must lead from the one to the other, since one alone may slip through a wall
    R16  sensing: at samples, or `exact`: a beam belongs to a zone from where it enters to where it
         leaves, and no border point stands on a straight wall but where its kind changes
    R17  tolerance: borders are reduced, each time from a core that is never simplified; they lie
         within the tolerance of the unreduced ones after any number of steps
"""

from semtopo.answers import Answer, History, answer, answer_question, understand
from semtopo.atlas import Atlas, Limits
from semtopo.borders import BorderPiece, border_pieces
from semtopo.codec import graph_body, zones_body
from semtopo.documents import (
    MappingDocument,
    PoseDocument,
    RecordedScan,
    ScanDocument,
    SensorDocument,
    WorldDocument,
)
from semtopo.doorways import Doorway, Doorways
from semtopo.errors import (
    AmbiguousQuestionError,
    AmbiguousZoneError,
    CrowdedQuestionError,
    InvalidInputError,
    InvalidMapError,
    InvalidOptionError,
    InvalidPathError,
    InvalidPoseError,
    InvalidQuestionError,
    InvalidRestrictionError,
    InvalidScanError,
    InvalidSensorError,
    InvalidWorldError,
    NotExportableError,
    SemtopoError,
    UnknownBorderError,
    UnknownPositionError,
    UnknownStepError,
    UnknownZoneError,
)
from semtopo.errors.ways import (
    GroundlessPassage,
    MissingPassage,
    NearestFrontier,
    NoRouteError,
    NotConnectedError,
    OutsideError,
    TooNarrowError,
    UnprovedPathError,
)
from semtopo.freespace import FreeSpace, Path
from semtopo.graph import (
    Node,
    NodeFound,
    NodeMerged,
    Passage,
    PassageFound,
    PassageJoined,
    TopologyGraph,
)
from semtopo.mapper import MapState, Stage, Step, explore, run, scan_world, step
from semtopo.metric import MappedZone, MetricMap
from semtopo.names import closest_names, resolve, resolve_class, resolve_one
from semtopo.notes import LabelRef, Restriction, ZoneNotes, ZoneRef
from semtopo.phrases import phrase
from semtopo.readback import read_map
from semtopo.reading import parse
from semtopo.route import CostModel, Place, Route, RouteRequest, find_routes, widest_place
from semtopo.runs import LabelledRuns, from_runs
from semtopo.scan import Scan, analyse
from semtopo.sensor import Measurement, Sensor, measure
from semtopo.sensor_map import SensorMap, extract
from semtopo.types import Edges, Identity, Kind, MappingOptions, Occupancy, Passages, Pose
from semtopo.world import World, WorldZone
from semtopo.zones import Zone

__all__ = [
    "AmbiguousQuestionError",
    "AmbiguousZoneError",
    "Answer",
    "Atlas",
    "BorderPiece",
    "CostModel",
    "CrowdedQuestionError",
    "Doorway",
    "Doorways",
    "Edges",
    "FreeSpace",
    "GroundlessPassage",
    "History",
    "Identity",
    "InvalidInputError",
    "InvalidMapError",
    "InvalidOptionError",
    "InvalidPathError",
    "InvalidPoseError",
    "InvalidQuestionError",
    "InvalidRestrictionError",
    "InvalidScanError",
    "InvalidSensorError",
    "InvalidWorldError",
    "Kind",
    "LabelRef",
    "LabelledRuns",
    "Limits",
    "MapState",
    "MappedZone",
    "MappingDocument",
    "MappingOptions",
    "Measurement",
    "MetricMap",
    "MissingPassage",
    "NearestFrontier",
    "NoRouteError",
    "Node",
    "NodeFound",
    "NodeMerged",
    "NotConnectedError",
    "NotExportableError",
    "Occupancy",
    "OutsideError",
    "Passage",
    "PassageFound",
    "PassageJoined",
    "Passages",
    "Path",
    "Place",
    "Pose",
    "PoseDocument",
    "RecordedScan",
    "Restriction",
    "Route",
    "RouteRequest",
    "Scan",
    "ScanDocument",
    "SemtopoError",
    "Sensor",
    "SensorDocument",
    "SensorMap",
    "Stage",
    "Step",
    "TooNarrowError",
    "TopologyGraph",
    "UnknownBorderError",
    "UnknownPositionError",
    "UnknownStepError",
    "UnknownZoneError",
    "UnprovedPathError",
    "World",
    "WorldDocument",
    "WorldZone",
    "Zone",
    "ZoneNotes",
    "ZoneRef",
    "analyse",
    "answer",
    "answer_question",
    "border_pieces",
    "closest_names",
    "explore",
    "extract",
    "find_routes",
    "from_runs",
    "graph_body",
    "measure",
    "parse",
    "phrase",
    "read_map",
    "resolve",
    "resolve_class",
    "resolve_one",
    "run",
    "scan_world",
    "step",
    "understand",
    "widest_place",
    "zones_body",
]
