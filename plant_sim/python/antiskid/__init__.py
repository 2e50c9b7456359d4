"""The anti-skid controller and its virtual rig, from Python. `__init__.pyi` is the manual; names carry their units."""
from ._native import Command, Controller, Ledger, Rig, Scenario, Sensors, __version__, fit_wear, landings_left, read_log

__all__ = ["Command", "Controller", "Ledger", "Rig", "Scenario", "Sensors", "fit_wear", "landings_left", "read_log", "stop"]


def stop(**keywords):
    """One braking maneuver, as `rig-lab stop` runs it."""
    return Scenario(**keywords).stop()
