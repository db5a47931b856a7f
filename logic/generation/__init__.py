"""From a request to a house: both stages, and the way back to the first."""
