"""How bodies move and see: an interface, and those that have it, continuous, free and grid."""
