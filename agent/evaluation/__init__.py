"""How good an agent is: episodes in houses that it did not learn in, beside baselines, with intervals."""
