"""Motion and sight of bodies: the interface of backends, and the backends continuous, free and grid."""
