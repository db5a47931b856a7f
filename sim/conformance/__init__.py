"""Whether vector environments, ours or anybody's, conform to Gymnasium's interface.

``claims.py`` checks an environment in its own autoreset mode. ``autoreset.py`` checks what each mode does at
an end, and that all three give the same episodes. ``trial.py`` calls the environment and checks each result.
"""

from sim.conformance.autoreset import check_autoreset_modes
from sim.conformance.claims import check_vector_env
from sim.conformance.trial import ConformanceError

__all__ = ["ConformanceError", "check_autoreset_modes", "check_vector_env"]
