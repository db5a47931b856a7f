"""From a request and a grammar that is loaded to a house: both stages, and the way back to the first."""
