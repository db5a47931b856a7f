"""What an agent does: networks and their memories, under a layer that avoids."""
