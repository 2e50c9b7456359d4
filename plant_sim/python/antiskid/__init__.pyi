"""The anti-skid controller and its virtual rig. Names carry their units; what is wrong in a configuration is an error that names file, line and key."""
from os import PathLike
from pathlib import Path
from typing import Any, Sequence, TypedDict

from numpy import float64
from numpy.typing import NDArray
from pandas import DataFrame
from typing_extensions import Unpack

__version__: str
Column = NDArray[float64]
Table = dict[str, NDArray[Any]]  # numbers, bools, or text as objects: pandas.DataFrame() takes it as it is

class Keywords(TypedDict, total=False):
    """Those of `rig-lab stop`."""

    maneuver: str  # light, medium_a, medium_b, heavy, endurance
    surface: str  # a table of surfaces.toml
    runway: str | PathLike[str]  # instead of the surface
    on_flywheel: bool
    mass_kg: float
    speed_mps: float
    mean_friction: float
    law: str  # slip, peak_slip, threshold, pressure_bias, deceleration
    slip: float  # reference, 0 to 0.5
    deceleration_mps2: float
    seed: int
    config: str | PathLike[str]  # directory; by default ./config, else /etc/antiskid
    controller: str | PathLike[str]
    dbc: str | PathLike[str]
    binding: str | PathLike[str]

def stop(**keywords: Unpack[Keywords]) -> dict[str, Any]:
    """One braking maneuver: figures as `rig-lab stop --json` has them."""

def drive(
    time_s: Sequence[float] | Column,
    *,
    pressure_Pa: Sequence[float] | Column | None = None,
    current_mA: Sequence[float] | Column | None = None,
    **keywords: Unpack[Keywords],
) -> dict[str, Column]:
    """Open loop, as `rig-lab drive`: the plant alone under a pressure or a current, linear between the times; a value each millisecond of time_s,
    speed_mps, wheel_speed_radps, slip, pressure_Pa, brake_torque_Nm, F_x_N, F_z_N, radius_m, mu, energy_brake_J, energy_tyre_J."""

def sweep(
    references: Sequence[float] | Column | None = None,
    *,
    landings: int = 100,
    threshold: bool = True,
    seed: int = 1,
    config: str | PathLike[str] | None = None,
    threads: int = 0,
) -> tuple[dict[str, Any], Table]:
    """The set-point study of Section VI, as `rig-lab sweep`: its results.json, and the columns of its stops.csv. `references`: 0.06 to 0.50 in
    hundredths by default; `threads`: 0 for all cores, the results are the same. Other threads run meanwhile; Ctrl-C ends it."""

def robust(
    *,
    families: Sequence[str] = ...,
    laws: Sequence[str] = ("slip", "threshold"),
    draws: int = 140,
    seed: int = 1,
    controller: str | PathLike[str] = "",
    ranges: str | PathLike[str] = "",
    config: str | PathLike[str] | None = None,
    threads: int = 0,
) -> tuple[dict[str, Any], Table]:
    """Stops on drawn plants and runways, as `rig-lab robust`: its results.json, and the columns of its stops.csv. Defaults are the verb's;
    `controller`, `ranges`: files instead of those of `config`. `threads` and Ctrl-C as for sweep()."""

def margins(
    *,
    slip: float = 0.24,
    speeds: int = 8,
    constant_slip: bool = False,
    mean_friction: float | None = None,
    controller: str | PathLike[str] = "",
    config: str | PathLike[str] | None = None,
) -> dict[str, Any]:
    """Margins of the slip loop on all surfaces and maneuvers over the speed range, as `rig-lab margins`: its results.json, a cell for each of
    `speeds` speeds in "cells". Defaults are the verb's; `controller`: a file instead of that of `config`. Ctrl-C as for sweep()."""

def endurance(
    out: str | PathLike[str],
    *,
    maneuvers: int = 500,
    seed: int = 1,
    scenario: str | PathLike[str] | None = None,
    config: str | PathLike[str] | None = None,
) -> dict[str, Any]:
    """A campaign of identical maneuvers until the brake is worn, as `rig-lab endurance`: its table.json, Table III. Leaves campaign.sqlite in the
    directory `out`, for Ledger(); a campaign that is there already goes on. A maneuver that is aborted is an error. Ctrl-C ends it after a
    maneuver, and it goes on when it is called again."""

def read_log(
    log: str | PathLike[str],
    *,
    scenario: str = "heavy",
    config: str | PathLike[str] = "",
    dbc: str | PathLike[str] = "",
    binding: str | PathLike[str] = "",
    interface: str | None = None,
) -> dict[str, Column]:
    """The samples of a log (candump, Vector ASC or BLF, PEAK TRC): the columns of `rig-replay export`. `scenario` says teeth and radii."""

def fit_wear(
    energy_J: Sequence[float] | Column,
    friction: Sequence[float] | Column,
    *,
    components: int = 15,
    starts: int = 100,
    seed: int = 1,
    floor: float = 1e-4,
    source: str = "arrays",
    origin: str = "",
    threads: int = 0,
) -> dict[str, Any]:
    """Gaussian mixtures of eq. (10) to (13) on a campaign's cumulative energy and mean friction, as `rig-lab wear fit`: its model.json. What
    json.dump() writes of it is a model for `rig-lab wear` and landings_left(). `components`: the most that are tried; `origin`: 'measured ...' or
    'made up ...'; `threads`: 0 for all cores, the model is the same. Ctrl-C ends it."""

def landings_left(
    energy_J: Sequence[float] | Column,
    friction: Sequence[float] | Column,
    population: str | PathLike[str],
    *,
    limit: float | None = None,
    mix: str = "",
    slip: float = 0.24,
    energy_MJ: float | None = None,
    last: int = 0,
    method: str = "shipped",
    horizon: int = 5000,
    draws: int = 2000,
    seed: int = 1,
    lining: tuple[Sequence[float] | Column, Sequence[float] | Column] = ([], []),
    config: str | PathLike[str] | None = None,
) -> dict[str, Any]:
    """Landings until the brake's mean friction is below `limit` (None: where its torque reserve is gone), as `rig-lab wear forecast`: its
    forecast.json with `landings_left` and `crossing_J` at 10, 50 and 90 %, and `provenance`, which says by which brakes. `population`:
    population.json of `rig-lab wear population` or a model of fit_wear(). Landings to come: `mix` such as 'light=0.5,heavy=0.5' held at `slip`, or
    `energy_MJ` each, or as the newest 100 were. `lining`: cumulative energy in J and worn share at each reading, as Ledger.lining() has them."""

class Ledger:
    """A campaign's ledger, read only: a bridge may be writing it meanwhile, or hold it."""

    def __init__(self, where: str | PathLike[str], campaign: str = "") -> None:
        """`where`: campaign.sqlite or its directory. `campaign` may be left out where there is one only."""
    @property
    def campaign(self) -> str: ...
    @property
    def file(self) -> Path: ...
    def rows(self) -> Table:
        """Every attempt, oldest first, amended and noted, as it is now: number, attempt, state, outcome, started, slip_reference,
        cumulative_energy_J, counted_J, figures as in summary.json, disc_energy_J, serial numbers, faults, warnings, health, ... What is not known
        is nan or empty."""
    def data_frame(self) -> DataFrame:
        """Of rows(). Needs pandas."""
    def wear(self, *, out_of_tolerance: bool = False) -> tuple[Column, Column]:
        """Cumulative energy in J and mean friction of every maneuver that `rig-lab wear fit` learns from: finished, within tolerance, of the newest
        brake and disc."""
    def lining(self) -> tuple[Column, Column]:
        """Cumulative energy in J and worn share of the lining (0: new, 1: at its limit) wherever it was read, of the newest brake and disc."""
    def simulated_wear(self, model: dict[str, Any], *, seed: int = 1, config: str | PathLike[str] | None = None) -> tuple[Column, Column]:
        """Fig. 9, as `rig-lab wear simulate --replay torque`: the maneuvers of wear() again on the endurance rig with their recorded torque and
        friction drawn from `model`, a dictionary of fit_wear(). Cumulative energy in J and mean friction. Ctrl-C ends it."""

class Regulator:
    """Shares the wear of brake and tyre between the two, landing by landing, through the slip reference: what `rig-bridge campaign --regulate`
    goes by. Plan, rules and floor are those of regulation.toml."""

    def __init__(
        self,
        landing_J: float,
        landing_deviation_J: float,
        *,
        landings: int | None = None,
        brake_life_J: float | None = None,
        brake_taken_J: float | None = None,
        tyre_life_J: float | None = None,
        config: str | PathLike[str] | None = None,
    ) -> None:
        """`landing_J`: kinetic energy of a landing, expected mean, and its standard deviation. The others: instead of the plan's and the brake's."""
    @property
    def reference(self) -> float:
        """For the next landing."""
    @property
    def range(self) -> tuple[float, float]:
        """References that the floor on J_mu allows."""
    @property
    def landings(self) -> int: ...
    @property
    def brake_left_J(self) -> float: ...
    @property
    def tyre_left_J(self) -> float: ...
    @property
    def required_share(self) -> float:
        """Of the energy still to come the tyre's part."""
    def after(self, *, kinetic_J: float, brake_J: float, tyre_J: float, j_mu: float = ..., reference: float | None = None) -> str:
        """What was measured of a landing; nan: not measured. `reference`: that was in force, if not the regulator's. How it was taken: measured,
        missing, negative, beyond_kinetic, energy_mismatch."""

class Scenario:
    """A maneuver, read and checked once. Other threads run while one of its stops does."""

    def __init__(self, **keywords: Unpack[Keywords]) -> None: ...
    def stop(self) -> dict[str, Any]: ...
    def recorded_stop(self) -> tuple[dict[str, Any], dict[str, Column]]:
        """Figures, and every control period: time_s, speed_mps, wheel_rim_speed_mps, slip, slip_reference, pressure_demand_Pa, pressure_Pa, ..."""
    def stops(self, slip: Sequence[float] | Column, seed: Sequence[int] = ..., threads: int = 1) -> dict[str, Column]:
        """A maneuver for each slip reference; one seed for all, or one for each. What does not apply is nan."""
    def drive(
        self,
        time_s: Sequence[float] | Column,
        *,
        pressure_Pa: Sequence[float] | Column | None = None,
        current_mA: Sequence[float] | Column | None = None,
    ) -> dict[str, Column]:
        """The plant alone, as drive()."""
    def rig(self) -> Rig:
        """A new rig before touchdown."""
    def controller(self) -> Controller:
        """A new controller as this scenario configures it."""

class Rig:
    """The other side of a controller: aircraft, wheel, brake, valve, sensors and pilot."""

    @property
    def done(self) -> bool: ...
    @property
    def braking(self) -> bool:
        """The pilot asks for the brake."""
    @property
    def period_s(self) -> float: ...
    @property
    def now_s(self) -> float: ...
    # The truth, which no sensor sees.
    @property
    def speed_mps(self) -> float: ...
    @property
    def wheel_speed_radps(self) -> float: ...
    @property
    def slip(self) -> float: ...
    @property
    def pressure_Pa(self) -> float: ...
    @property
    def demand_Pa(self) -> float: ...
    def current_for_mA(self, pressure_Pa: float) -> float:
        """By the valve's static map."""
    def sensors(self) -> Sensors:
        """What the frames of this period say, rounded as they are."""
    def advance(self, current_mA: float) -> None:
        """One period with that valve current."""
    def apply(self, command: Command) -> None:
        """One period with what a controller decided."""
    def figures(self) -> dict[str, Any]:
        """As stop()."""

class Sensors:
    """What a controller may know at a step. Those of a rig may be changed, to try a sensor's fault; a new one has heard of nothing yet. `..._received_s`:
    when that was heard last, by the clock of Controller.step(); nan: never. What is too old is a fault."""

    def __init__(self) -> None: ...
    wheel_edge_count: int  # since any start; rolls over at 2^32
    wheel_edge_s: float  # time of that edge, by the sensor's own clock
    wheel_received_s: float
    flywheel_edge_count: int
    flywheel_edge_s: float
    flywheel_received_s: float
    pressure_Pa: float
    pressure_received_s: float
    arm: bool  # false to true earns permission
    weight_on_wheels: bool
    demand_Pa: float  # the ceiling of brake pressure
    slip_reference: float
    maneuver_received_s: float  # of the four above
    rig_heartbeat_received_s: float
    emergency_stop: bool

class Command:
    current_mA: float
    @property
    def slip(self) -> float: ...
    @property
    def slip_reference(self) -> float: ...
    @property
    def speed_mps(self) -> float: ...
    @property
    def wheel_speed_radps(self) -> float: ...
    @property
    def pressure_request_Pa(self) -> float: ...
    @property
    def state(self) -> str: ...
    @property
    def faults(self) -> list[str]: ...

class Controller:
    """The controller that flies on the rig: firmware/control, the same objects."""

    def __init__(self, config: str | PathLike[str]) -> None: ...
    def step(self, sensors: Sensors, now_s: float) -> Command: ...
