"""Shapes of rooms: along the axes, cut at doorways and to boxes, with walls without a thickness."""
