"""How good agents are: episodes in houses that are new to them, beside baselines."""
