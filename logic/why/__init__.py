"""Why a part of a house is as it is: its derivation, and what else could be."""
