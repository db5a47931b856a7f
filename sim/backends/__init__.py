"""How bodies move and see: an interface, and two that have it, continuous and grid."""
