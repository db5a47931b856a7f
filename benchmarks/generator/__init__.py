"""How hard a house is, how evenly houses are sampled, and whether they keep their promises."""
