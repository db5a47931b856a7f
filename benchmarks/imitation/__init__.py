"""``vitruvius bench imitation``: what a network without a map learns from the explorer, then by reward."""
