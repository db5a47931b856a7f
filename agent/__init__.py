"""Learning agents and the vitruvius command."""
