"""Agents that explore houses: planners and trained policies, their evaluation, and games with people."""
