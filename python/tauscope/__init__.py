"""Says what the dynamic model of a robot arm misses, by how much, and what to do about it.

    import tauscope

    arm = tauscope.Robot("arm.urdf")
    monday = tauscope.Log(t=t, q=q, tau=tau)                 # arrays of samples x joints, SI units
    answer = tauscope.diagnose(arm, train=monday, test="tuesday.csv")
    print(answer)

Every command of ``tauscope`` is a function here and gives the same numbers. Answers have the fields of the command's JSON as
attributes.
"""

from ._answer import Answer, Node, Simulated
from ._commands import (
    blind,
    check,
    command,
    diagnose,
    effects,
    excite,
    identify,
    inspect,
    montecarlo,
    paper,
    payload,
    run,
    simulate,
    view,
)
from ._log import Log
from ._robot import BaseParameters, Robot
from ._scenario import read_scenario
from ._tauscope import TauscopeError, __version__

# The answer that a command gave before it refused a log.
TauscopeError.answer = None

__all__ = [
    "Answer",
    "BaseParameters",
    "Log",
    "Node",
    "Robot",
    "Simulated",
    "TauscopeError",
    "__version__",
    "blind",
    "check",
    "command",
    "diagnose",
    "effects",
    "excite",
    "identify",
    "inspect",
    "montecarlo",
    "paper",
    "payload",
    "read_scenario",
    "run",
    "simulate",
    "view",
]
