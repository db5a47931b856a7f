"""The independent check: plain geometry on a finished house, by what it promises."""
