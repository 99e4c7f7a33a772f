"""Reference solutions: closed formulas, series and small integrations, for any parameters.

They use NumPy and SciPy and nothing of the simulation, so they can judge a run of your own:

    frame = Trajectory("run.lammpstrj", "log.lammps")[-1]
    exact = CouetteStart(gap=1e-3, nu=1e-6, lid=1e-5).velocity(frame.positions[:, 1], frame.time)

Units are those in the docstrings, SI, or any other consistent set. Formulas and sources stand at
the head of each module. Parameters for which there is no such scene, and places and times for which
there is no value, raise :class:`~sphcloth.errors.UserError`.
"""

from __future__ import annotations

from sphcloth.references.added_mass_piston import Piston
from sphcloth.references.balloon import BreathingShell
from sphcloth.references.blob_on_free_sheet import Collision
from sphcloth.references.bulge import Bulge
from sphcloth.references.cantilever import HeavyElastica
from sphcloth.references.catenary import HangingPolygon
from sphcloth.references.chain import LinkedPendulum
from sphcloth.references.couette import CouetteStart
from sphcloth.references.dam_break import Column
from sphcloth.references.drain import DrainingColumn
from sphcloth.references.filled_sheet import FilledSheet
from sphcloth.references.hanging_chain import HangingChain
from sphcloth.references.hencky import PressurizedMembrane, PressurizedNet
from sphcloth.references.hydrostatic import TaitColumn
from sphcloth.references.jet import Jet
from sphcloth.references.jet_on_sheet import TurnedJet
from sphcloth.references.lintearia import HeavyLintearia, Lintearia
from sphcloth.references.net_drag import measured_drag
from sphcloth.references.oscillating_drop import EllipticDrop
from sphcloth.references.pendulum import pendulum_period
from sphcloth.references.pinned_weight import Load
from sphcloth.references.poiseuille import PoiseuilleStart
from sphcloth.references.rest_angle import hinge_angles
from sphcloth.references.standing_wave import StandingWave
from sphcloth.references.taylor_green import TaylorGreen
from sphcloth.references.terminal_velocity import FallingSheet
from sphcloth.references.wind_pendulum import WindPendulum
from sphcloth.references.xpbd_oscillator import Oscillator

__all__ = [
    "BreathingShell",
    "Bulge",
    "Collision",
    "Column",
    "CouetteStart",
    "DrainingColumn",
    "EllipticDrop",
    "FallingSheet",
    "FilledSheet",
    "HangingChain",
    "HangingPolygon",
    "HeavyElastica",
    "HeavyLintearia",
    "Jet",
    "LinkedPendulum",
    "Lintearia",
    "Load",
    "Oscillator",
    "Piston",
    "PoiseuilleStart",
    "PressurizedMembrane",
    "PressurizedNet",
    "StandingWave",
    "TaitColumn",
    "TaylorGreen",
    "TurnedJet",
    "WindPendulum",
    "hinge_angles",
    "measured_drag",
    "pendulum_period",
]
