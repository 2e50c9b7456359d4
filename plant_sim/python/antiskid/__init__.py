"""The anti-skid controller and its virtual rig, from Python. `__init__.pyi` is the manual; names carry their units."""
import csv
import json

import numpy

from . import _native
from ._native import Command, Controller, Ledger, Regulator, Rig, Scenario, Sensors, __version__, fit_wear, landings_left, read_log

__all__ = ["Command", "Controller", "Ledger", "Regulator", "Rig", "Scenario", "Sensors", "drive", "endurance", "fit_wear", "landings_left",
           "margins", "read_log", "robust", "stop", "sweep"]

# What is no float in a table of stops.
_SWEEP = {"law": object, "surface": object, "maneuver": object, "standstill": object, "faults": object,
          "stop": numpy.int64, "landing": numpy.int64, "sensor_seed": numpy.uint64}
_ROBUST = {"family": object, "law": object, "what": object, "draw": numpy.int64, "faults": numpy.int64}


def stop(**keywords):
    """One braking maneuver, as `rig-lab stop` runs it."""
    return Scenario(**keywords).stop()


def drive(time_s, *, pressure_Pa=None, current_mA=None, **keywords):
    """Open loop, as `rig-lab drive`."""
    return Scenario(**keywords).drive(time_s, pressure_Pa=pressure_Pa, current_mA=current_mA)


def sweep(references=None, **keywords):
    """The set-point study, as `rig-lab sweep`: its results and its table of stops."""
    results, stops = _native.sweep(references, **keywords)
    return json.loads(results), _table(stops, _SWEEP)


def robust(**keywords):
    """Stops on drawn plants, as `rig-lab robust`: its results and its table of stops."""
    results, stops = _native.robust(**keywords)
    return json.loads(results), _table(stops, _ROBUST)


def margins(**keywords):
    """Phase and gain margins, as `rig-lab margins`: its results."""
    return json.loads(_native.margins(**keywords))


def endurance(out, **keywords):
    """A campaign of identical maneuvers, as `rig-lab endurance`: its table."""
    return json.loads(_native.endurance(out, **keywords))


def _table(text, kinds):
    """An array of each column; numbers are floats where `kinds` says nothing else, and nan where nothing stands."""
    head, *rows = csv.reader(line for line in text.splitlines() if not line.startswith("#"))
    columns = {}
    for name, cells in zip(head, zip(*rows)):
        kind = kinds.get(name, float)
        if kind is float:
            cells = [float(cell or "nan") for cell in cells]
        elif kind is not object:
            cells = [int(cell) for cell in cells]
        columns[name] = numpy.array(cells, dtype=kind)
    return columns
