"""Policies: networks and their memories, under a layer that avoids obstacles."""
