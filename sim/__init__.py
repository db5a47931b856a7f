"""Many environments stepped at once, behind Gymnasium."""
