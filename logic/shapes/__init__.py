"""Operations on shapes of rooms: align walls with the axes, find doorways, cut rooms into boxes."""
