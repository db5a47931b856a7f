"""How hard a house is: solve time, how evenly houses are sampled, and whether they keep their promises."""
