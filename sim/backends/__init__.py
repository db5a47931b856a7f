"""How bodies move and see: a protocol, and the two that come with it, continuous and grid."""
