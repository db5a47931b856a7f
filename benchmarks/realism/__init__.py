"""Whether plans of two sets, generated or real, are alike; weights with which generated ones are more so."""
