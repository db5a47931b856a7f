"""Interface of Gymnasium: many environments at once, or a single one."""
