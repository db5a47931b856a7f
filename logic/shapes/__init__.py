"""Operations on shapes of rooms: align walls with the axes, cut at doorways and into boxes, and merge the
two faces of a wall.
"""
